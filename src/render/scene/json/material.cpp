// Materials of the JSON scene file, and the names by which shapes find them.
#include <fmt/format.h>

#include <algorithm>

#include "render/scene/json/parts.h"

namespace psf::render {

namespace {

int read_picture(const JsonCursor& json, JsonLoad& load, const Material& material,
                 std::string_view key, TextureUse use) {
  const auto file = json.find(key);
  if (!file) return kNone;
  return load.textures.load(file->file(), file->text(), use,
                            [&] { return file->where() + ": material \"" + material.name + "\""; });
}

// For a key that says how much of another one there is.
void want_beside(const JsonCursor& json, const char* key, const char* other) {
  const auto found = json.find(key);
  if (found && !json.find(other))
    found->fail(fmt::format("does nothing without \"{}\"; add one, or leave it out", other));
}

void read_pictures(const JsonCursor& json, JsonLoad& load, Material& material) {
  const auto texture = [&](std::string_view key, TextureUse use) {
    return read_picture(json, load, material, key, use);
  };
  material.reflectance_texture = texture("reflectance_map", TextureUse::reflectance);
  material.emission_texture = texture("emission_map", TextureUse::radiance);
  material.roughness_metalness_texture = texture("roughness_metalness_map", TextureUse::numbers);
  material.opacity_texture = texture("opacity_map", TextureUse::opacity);
  material.normal_texture = texture("normal_map", TextureUse::numbers);
  want_beside(json, "normal_scale", "normal_map");
  if (const auto s = json.find("normal_scale")) material.normal_scale = s->number(kNonNegative);
  material.bump_texture = texture("bump_map", TextureUse::numbers);
  want_beside(json, "bump_height", "bump_map");
  if (json.find("bump_map"))
    material.bump_height = load.scene.space.local_length(json.at("bump_height").real());
}

// The second coat, above that of the kind.
void read_clearcoat(const JsonCursor& json, JsonLoad& load, Material& material) {
  for (const char* key :
       {"clearcoat", "clearcoat_map", "clearcoat_roughness", "clearcoat_roughness_map"}) {
    const auto found = json.find(key);
    if (found && material.kind != MaterialKind::coat)
      found->fail("only materials of the kind coat have a clear coat; leave it out");
  }
  const char* const there = json.find("clearcoat_map") ? "clearcoat_map" : "clearcoat";
  want_beside(json, "clearcoat_roughness", there);
  want_beside(json, "clearcoat_roughness_map", there);
  // A picture is shown as it is, where nothing else is said.
  const auto share = [&](const char* key, const char* map, float& value, int& texture) {
    texture = read_picture(json, load, material, map, TextureUse::numbers);
    if (json.find(map)) value = 1;
    if (const auto found = json.find(key)) value = found->number(kUnitRange);
  };
  share("clearcoat", "clearcoat_map", material.clearcoat, material.clearcoat_texture);
  share("clearcoat_roughness", "clearcoat_roughness_map", material.clearcoat_roughness,
        material.clearcoat_roughness_texture);
}

// Light passes the boundary of a medium by its own laws.
void refuse_opacity(const JsonCursor& json) {
  for (const char* key : {"opacity", "opacity_map", "opacity_cutoff"}) {
    if (const auto found = json.find(key)) {
      found->fail("materials with an interior are never there in part; leave it out");
    }
  }
}

// Its surface is never met, so that only light sampling would find it.
void refuse_emission(const JsonCursor& json) {
  for (const char* key : {"emission", "emission_map"}) {
    if (const auto found = json.find(key)) {
      found->fail("the surface of a volume is not seen, so it has no light; put a lamp into it");
    }
  }
}

}  // namespace

void read_material(const JsonCursor& json, JsonLoad& load) {
  static constexpr std::string_view kKinds[] = {"diffuse", "mirror",     "glass", "conductor",
                                                "coat",    "subsurface", "volume"};
  // In the same order; `gloss` has no name here.
  static constexpr MaterialKind kValues[] = {
      MaterialKind::diffuse, MaterialKind::mirror,     MaterialKind::glass, MaterialKind::conductor,
      MaterialKind::coat,    MaterialKind::subsurface, MaterialKind::volume};
  json.check_keys({"name",
                   "kind",
                   "reflectance",
                   "reflectance_map",
                   "roughness",
                   "metalness",
                   "roughness_metalness_map",
                   "ior",
                   "interior",
                   "two_sided",
                   "emission",
                   "emission_map",
                   "emits_two_sided",
                   "opacity",
                   "opacity_map",
                   "opacity_cutoff",
                   "multiple_scattering",
                   "normal_map",
                   "normal_scale",
                   "bump_map",
                   "bump_height",
                   "clearcoat",
                   "clearcoat_map",
                   "clearcoat_roughness",
                   "clearcoat_roughness_map"});
  Material material;
  const JsonCursor name = json.at("name");
  material.name = name.text();
  for (const Material& other : load.scene.materials) {
    if (other.name == material.name)
      name.fail("another material is called \"" + material.name + "\"");
  }
  if (const auto kind = json.find("kind")) material.kind = kValues[kind->choice(kKinds)];
  // Mirrors and glass lose nothing, and a picture is shown as it is, where nothing else is said.
  const bool lossless =
      material.kind == MaterialKind::mirror || material.kind == MaterialKind::glass;
  if (lossless || json.find("reflectance_map")) material.reflectance = Rgb(1);
  if (const auto c = json.find("reflectance")) material.reflectance = c->rgb(kUnitRange);
  if (const auto r = json.find("roughness")) material.roughness = r->number(kUnitRange);
  if (const auto m = json.find("metalness")) material.metalness = m->number(kUnitRange);
  if (const auto b = json.find("multiple_scattering")) material.multiple_scattering = b->boolean();
  if (const auto i = json.find("ior")) material.ior = i->number({1, 10, "in [1, 10]"});
  if (material.kind == MaterialKind::subsurface || material.kind == MaterialKind::volume) {
    material.interior = read_medium_name(json, "interior", load.scene);
    refuse_opacity(json);
    if (material.kind == MaterialKind::volume) refuse_emission(json);
  } else if (const auto interior = json.find("interior")) {
    interior->fail("only materials of the kinds subsurface and volume have one");
  }
  if (const auto t = json.find("two_sided")) material.two_sided = t->boolean();
  if (const auto t = json.find("emits_two_sided")) material.emits_two_sided = t->boolean();
  if (const auto o = json.find("opacity")) material.opacity = o->number(kUnitRange);
  if (const auto o = json.find("opacity_cutoff")) material.opacity_cutoff = o->number(kUnitRange);
  if (json.find("emission_map")) material.emission = Rgb(1);
  if (const auto e = json.find("emission")) material.emission = e->rgb(kNonNegative);

  read_clearcoat(json, load, material);
  read_pictures(json, load, material);
  load.scene.materials.push_back(std::move(material));
}

int read_material_name(const JsonCursor& json, const Scene& scene, bool required,
                       std::string_view key) {
  const auto found = json.find(key);
  if (!found && !required) return kNone;
  const JsonCursor cursor = json.at(key);
  const std::string name = cursor.text();
  const auto material = std::find_if(scene.materials.begin(), scene.materials.end(),
                                     [&](const Material& m) { return m.name == name; });
  if (material == scene.materials.end()) {
    std::vector<std::string_view> known;
    for (const Material& m : scene.materials) known.push_back(m.name);
    cursor.fail("no material is called \"" + name + "\"" + suggestion(name, known));
  }
  return static_cast<int>(material - scene.materials.begin());
}

}  // namespace psf::render
