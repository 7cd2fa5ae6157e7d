// Materials of the JSON scene file, and the names by which shapes find them.
#include <algorithm>

#include "render/scene/json/parts.h"

namespace psf::render {

namespace {

void read_pictures(const JsonCursor& json, JsonLoad& load, Material& material) {
  const auto texture = [&](std::string_view key, TextureUse use) {
    const auto file = json.find(key);
    if (!file) return kNone;
    return load.textures.load(file->file(), file->text(), use, [&] {
      return file->where() + ": material \"" + material.name + "\"";
    });
  };
  material.reflectance_texture = texture("reflectance_map", TextureUse::reflectance);
  material.emission_texture = texture("emission_map", TextureUse::radiance);
  material.roughness_metalness_texture = texture("roughness_metalness_map", TextureUse::numbers);
  material.opacity_texture = texture("opacity_map", TextureUse::opacity);
  material.normal_texture = texture("normal_map", TextureUse::numbers);
  if (const auto s = json.find("normal_scale")) material.normal_scale = s->number(kNonNegative);
  material.bump_texture = texture("bump_map", TextureUse::numbers);
  if (json.find("bump_map"))
    material.bump_height = load.scene.space.local_length(json.at("bump_height").real());
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
                   "bump_height"});
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
