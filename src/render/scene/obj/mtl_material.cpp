// MTL's materials to ours; the table of it stands in sample_data/README.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "render/scene/obj/mtl.h"
#include "render/scene/text_lines.h"

namespace psf::render {
namespace {

// Phong exponent to perceptual roughness: alpha^2 = 2 / (Ns + 2), roughness^2 = alpha. Old
// exporters write negative exponents for none.
float roughness_of(float exponent) {
  return std::pow(2 / (std::max(exponent, 0.0f) + 2), 0.25f);
}

// d counts where a material has both: half of the programs that write Tr mean d by it.
float opacity(const MtlMaterial& mtl, LeftOut& left_out) {
  if (!mtl.d) return 1 - mtl.tr.value_or(0);
  if (mtl.tr && std::abs(*mtl.d + *mtl.tr - 1) > 1e-3f) left_out.add("Tr that contradicts d");
  return *mtl.d;
}

bool has_any(const MtlMaterial& mtl) {
  return mtl.kd || mtl.ks || mtl.ke || !mtl.map_kd.file.empty() || !mtl.map_ke.file.empty();
}

Rgb square_root(const Rgb& c) {
  return {std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)};
}

// Sets kind and the numbers of reflection.
void set_reflection(const MtlMaterial& mtl, Material& material, LeftOut& left_out) {
  // A picture of opacities says where a sheet is, no body of glass has one.
  const float opaque = mtl.map_d.file.empty() ? material.opacity : 1;
  const int illum = mtl.illum.value_or(mtl.ks ? 2 : 1);
  const bool refracts = illum == 4 || illum == 6 || illum == 7 || illum == 9;
  const Rgb specular = mtl.ks.value_or(Rgb(0));
  const bool has_map = !mtl.map_kd.file.empty();
  // The map multiplies Kd; a material that says nothing is grey as those that are not there.
  material.reflectance = mtl.kd.value_or(has_map ? Rgb(1) : has_any(mtl) ? Rgb(0) : Rgb(0.5f));
  const bool has_base = has_map || !is_black(material.reflectance);
  if (mtl.ni && *mtl.ni > 0) material.ior = *mtl.ni;

  if (refracts || opaque < 0.5f) {
    material.kind = MaterialKind::glass;
    material.opacity = 1;
    // Light crosses a closed body's surface twice.
    material.reflectance = square_root(mtl.tf.value_or(Rgb(1)));
    if (has_map) left_out.add("map_Kd of glass");
    if (!mtl.map_d.file.empty()) left_out.add("map_d of glass");
    return;
  }
  if (mtl.pr || mtl.pm) {
    material.kind = MaterialKind::coat;
    material.roughness = mtl.pr ? *mtl.pr : mtl.ns ? roughness_of(*mtl.ns) : 0.5f;
    material.metalness = mtl.pm.value_or(0);
  } else if (illum >= 2 && illum <= 9 && !is_black(specular)) {
    const bool sharp = illum == 3 || illum == 5 || illum == 8;
    material.roughness = sharp ? 0 : roughness_of(mtl.ns.value_or(0));
    material.kind = has_base ? MaterialKind::gloss
                    : sharp  ? MaterialKind::mirror
                             : MaterialKind::conductor;
    material.specular = specular;
    if (!has_base) material.reflectance = specular;
  }
}

}  // namespace

Material to_material(const MtlMaterial& mtl, const std::string& path, TextureTable& textures,
                     LeftOut& left_out) {
  Material material;
  material.name = mtl.name;
  material.two_sided = material.emits_two_sided = true;
  material.opacity = opacity(mtl, left_out);
  set_reflection(mtl, material, left_out);
  material.emission = mtl.ke.value_or(Rgb(0));
  if (!mtl.map_ke.file.empty() && is_black(material.emission)) material.emission = Rgb(1);

  const auto load = [&](const MtlMaterial::Map& map, TextureUse use) {
    if (map.file.empty()) return kNone;
    const std::string found = find_named(path, map.file);
    return textures.load(path, found.empty() ? map.file : found, use, [&] {
      return fmt::format("{}:{}: material {}", path, map.line, mtl.name);
    });
  };
  if (material.kind == MaterialKind::diffuse || material.kind == MaterialKind::coat ||
      material.kind == MaterialKind::gloss)
    material.reflectance_texture = load(mtl.map_kd, TextureUse::reflectance);
  material.emission_texture = load(mtl.map_ke, TextureUse::radiance);
  material.normal_texture = load(mtl.relief, TextureUse::relief);
  material.normal_scale = mtl.relief.multiplier;
  if (material.kind != MaterialKind::glass)
    material.opacity_texture = load(mtl.map_d, TextureUse::opacity);
  // Nothing glows for want of its picture.
  if (material.emission_texture == kNone && !mtl.map_ke.file.empty()) material.emission = Rgb(0);
  return material;
}

}  // namespace psf::render
