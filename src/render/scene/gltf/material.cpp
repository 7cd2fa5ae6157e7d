// Materials of a glTF file. The mapping is documented in sample_data/README.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "render/scene/gltf/parts.h"

namespace psf::render {
namespace {

// What a converter rounded is no error; the check of every scene clamps it.
constexpr Range kUnit{0, 1.0001, "in [0, 1]"};

// One material while it is read: notes what is left out of it under its place.
struct Reader {
  GltfLoad& load;
  JsonCursor json;
  std::size_t index;
  std::string place;
  Material material{};
  std::optional<GltfCoordinates> coordinates{};  // coordinates of the first texture

  void leave_out(const std::string& what) { load.leave_out(what, place); }

  int texture(const JsonCursor& object, const char* key, TextureUse use, const char* slot,
              std::initializer_list<std::string_view> known = {"index", "texCoord"}) {
    const auto info = object.find(key);
    if (!info) return kNone;
    load.check_keys(*info, known);
    const int found = gltf_texture(load, *info, use, fmt::format("{}: {}", place, slot));
    const GltfCoordinates c = gltf_coordinates(load, *info);
    if (found == kNone) return kNone;
    if (!coordinates) coordinates = c;
    if (!(*coordinates == c)) {
      leave_out("textures of one material share the coordinates of the first");
    }
    return found;
  }
  static float number(const JsonCursor& object, const char* key, float otherwise,
                      const Range& range) {
    const auto found = object.find(key);
    return found ? found->number(range) : otherwise;
  }
  static Rgb colour(const JsonCursor& object, const char* key, float otherwise, const Range& range,
                    std::size_t numbers = 3) {
    const auto found = object.find(key);
    return found ? to_rgb(found->numbers(numbers, range)) : Rgb(otherwise);
  }
  void note_textures(const JsonCursor& object, const char* extension,
                     std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
      if (object.find(key)) leave_out(fmt::format("{} of {} is left out", key, extension));
    }
  }

  void metallic_roughness(const JsonCursor& pbr);
  void specular_glossiness(const JsonCursor& extension);
  void dielectric();
  void clearcoat(const JsonCursor& extension);
  void emission();
  void transmission(const JsonCursor& extension);
  void unlit();
  void alpha();
  void relief();
  void note_others();
  Material convert();
};

// The index of refraction of a dielectric of this reflectance at normal incidence.
float index_of(float reflectance) {
  const float root = std::sqrt(std::clamp(reflectance, 0.0f, 0.99f));
  return std::min((1 + root) / (1 - root), 10.0f);
}

void Reader::metallic_roughness(const JsonCursor& pbr) {
  load.check_keys(pbr, {"baseColorFactor", "baseColorTexture", "metallicFactor", "roughnessFactor",
                        "metallicRoughnessTexture"});
  material.reflectance = colour(pbr, "baseColorFactor", 1, kUnit, 4);
  material.roughness = number(pbr, "roughnessFactor", 1, kUnit);
  material.metalness = number(pbr, "metallicFactor", 1, kUnit);
  material.reflectance_texture =
      texture(pbr, "baseColorTexture", TextureUse::reflectance, "base colour");
  material.roughness_metalness_texture =
      texture(pbr, "metallicRoughnessTexture", TextureUse::numbers, "metallic-roughness");
}

// To metallic-roughness, by the formula of the extension's appendix; a dielectric keeps its
// reflectance by an index of refraction of its own.
void Reader::specular_glossiness(const JsonCursor& extension) {
  constexpr float kDielectric = 0.04f, kMostDielectric = 0.08f;
  load.check_keys(extension, {"diffuseFactor", "diffuseTexture", "specularFactor",
                              "glossinessFactor", "specularGlossinessTexture"});
  const Rgb diffuse = colour(extension, "diffuseFactor", 1, kUnit, 4);
  const Rgb specular = colour(extension, "specularFactor", 1, kUnit);
  material.roughness = 1 - std::min(number(extension, "glossinessFactor", 1, kUnit), 1.0f);
  material.metalness = 0;
  material.reflectance_texture =
      texture(extension, "diffuseTexture", TextureUse::reflectance, "diffuse colour");
  if (extension.find("specularGlossinessTexture")) {
    // Without its picture nothing is known of the highlight.
    leave_out(
        "specularGlossinessTexture of KHR_materials_pbrSpecularGlossiness is left out, such "
        "materials are diffuse");
    material.kind = MaterialKind::diffuse;
    material.reflectance = diffuse;
    return;
  }
  const float strongest = std::min(max_component(specular), 1.0f);
  if (strongest <= kMostDielectric) {
    material.reflectance = diffuse;
    material.ior = index_of((specular.x + specular.y + specular.z) / 3);
    return;
  }
  const auto brightness = [](const Rgb& c) {
    return std::sqrt(0.299f * c.x * c.x + 0.587f * c.y * c.y + 0.114f * c.z * c.z);
  };
  const float d = brightness(diffuse), s = brightness(specular);
  const float b = d * (1 - strongest) / (1 - kDielectric) + s - 2 * kDielectric;
  const float root = b * b - 4 * kDielectric * (kDielectric - s);
  const float metal =
      std::clamp((-b + std::sqrt(std::max(root, 0.0f))) / (2 * kDielectric), 0.0f, 1.0f);
  const Rgb from_diffuse =
      diffuse * ((1 - strongest) / (1 - kDielectric) / std::max(1 - metal, 1e-4f));
  const Rgb from_specular =
      (specular - Rgb(kDielectric * (1 - metal))) * (1 / std::max(metal, 1e-4f));
  material.metalness = metal;
  for (int k = 0; k < 3; ++k) {
    material.reflectance[k] = std::clamp(
        from_diffuse[k] + (from_specular[k] - from_diffuse[k]) * metal * metal, 0.0f, 1.0f);
  }
}

// KHR_materials_ior and KHR_materials_specular: the index of the same reflectance at normal
// incidence.
void Reader::dielectric() {
  float at_normal = -1;
  if (const auto extension = find_extension(json, "KHR_materials_ior")) {
    load.check_keys(*extension, {"ior"});
    const auto ior = extension->find("ior");
    const float n = ior ? ior->number({0, 10, "from 1 to 10, or 0"}) : 1.5f;
    if (n != 0 && n < 1) ior->expected("a number from 1 to 10, or 0");
    material.ior = std::max(n, 1.0f);
    at_normal = n == 0 ? 1 : (n - 1) * (n - 1) / ((n + 1) * (n + 1));
  }
  if (const auto extension = find_extension(json, "KHR_materials_specular")) {
    constexpr const char* kName = "KHR_materials_specular";
    load.check_keys(*extension, {"specularFactor", "specularTexture", "specularColorFactor",
                                 "specularColorTexture"});
    note_textures(*extension, kName, {"specularTexture", "specularColorTexture"});
    const Rgb tint = colour(*extension, "specularColorFactor", 1, kNonNegative);
    if (tint.x != tint.y || tint.y != tint.z)
      leave_out("the colour of KHR_materials_specular is taken for a grey of its mean");
    if (at_normal < 0) at_normal = 0.04f;
    at_normal *= number(*extension, "specularFactor", 1, kUnit) * (tint.x + tint.y + tint.z) / 3;
    material.ior = index_of(at_normal);
  } else if (at_normal == 1) {
    material.ior = index_of(1);
  }
}

// What is not a coat after all, as glass and unlit materials, has none above it.
void Reader::clearcoat(const JsonCursor& extension) {
  constexpr const char* kName = "KHR_materials_clearcoat";
  load.check_keys(extension, {"clearcoatFactor", "clearcoatTexture", "clearcoatRoughnessFactor",
                              "clearcoatRoughnessTexture", "clearcoatNormalTexture"});
  const float factor = std::min(number(extension, "clearcoatFactor", 0, kUnit), 1.0f);
  if (factor == 0) return;
  if (material.kind != MaterialKind::coat)
    return leave_out(fmt::format("{} on what is no metallic-roughness is left out", kName));
  material.clearcoat = factor;
  material.clearcoat_roughness =
      std::min(number(extension, "clearcoatRoughnessFactor", 0, kUnit), 1.0f);
  material.clearcoat_texture =
      texture(extension, "clearcoatTexture", TextureUse::numbers, "clear coat");
  material.clearcoat_roughness_texture = texture(extension, "clearcoatRoughnessTexture",
                                                 TextureUse::numbers, "clear coat's roughness");
  const auto picture = [](const JsonCursor& object, const char* key) {
    const auto info = object.find(key);
    return info ? std::optional(info->at("index").whole()) : std::nullopt;
  };
  // One shading normal for all that a surface has.
  if (picture(extension, "clearcoatNormalTexture") != picture(json, "normalTexture"))
    leave_out("a clear coat has the relief of what is beneath it");
}

void Reader::emission() {
  material.emission = colour(json, "emissiveFactor", 0, kNonNegative);
  if (const auto extension = find_extension(json, "KHR_materials_emissive_strength")) {
    load.check_keys(*extension, {"emissiveStrength"});
    material.emission *= number(*extension, "emissiveStrength", 1, kNonNegative);
  }
  material.emission_texture = texture(json, "emissiveTexture", TextureUse::radiance, "emission");
  // Nothing glows for want of its picture.
  if (material.emission_texture == kNone && json.find("emissiveTexture"))
    material.emission = Rgb(0);
}

void Reader::transmission(const JsonCursor& extension) {
  load.check_keys(extension, {"transmissionFactor", "transmissionTexture"});
  note_textures(extension, "KHR_materials_transmission", {"transmissionTexture"});
  const float factor = number(extension, "transmissionFactor", 0, kUnit);
  if (factor == 0) return;
  if (factor <= 0.5f) {
    leave_out("transmission of at most a half is left out, such materials are opaque");
  } else if (material.roughness >= 0.3f) {
    leave_out("rough transmission is left out, such materials are opaque");
  } else {
    material.kind = MaterialKind::glass;
    const auto volume = find_extension(json, "KHR_materials_volume");
    if (!volume || number(*volume, "thicknessFactor", 0, kNonNegative) == 0)
      leave_out("thin glass refracts as a solid body does");
  }
}

// Its colour, whatever the light.
void Reader::unlit() {
  const auto pbr = json.find("pbrMetallicRoughness");
  coordinates.reset();
  material.kind = MaterialKind::diffuse;
  material.emission = material.reflectance;
  material.emission_texture =
      pbr ? texture(*pbr, "baseColorTexture", TextureUse::radiance, "base colour") : kNone;
  material.reflectance = Rgb(0);
  material.reflectance_texture = material.roughness_metalness_texture = kNone;
  leave_out("unlit materials shine in their colour (KHR_materials_unlit)");
}

// Alpha is that of the base colour: its factor, and the same picture again.
void Reader::alpha() {
  static constexpr std::string_view kModes[] = {"OPAQUE", "MASK", "BLEND"};
  enum : std::size_t { opaque, mask };
  const auto found = json.find("alphaMode");
  const std::size_t mode = found ? found->choice(kModes) : opaque;
  const float cutoff = number(json, "alphaCutoff", 0.5f, kNonNegative);
  if (mode == opaque || (mode == mask && cutoff == 0)) return;
  if (mode == mask) material.opacity_cutoff = cutoff;
  const auto glossy = find_extension(json, "KHR_materials_pbrSpecularGlossiness");
  const auto pbr = glossy ? glossy : json.find("pbrMetallicRoughness");
  if (!pbr) return;
  if (const auto factor = pbr->find(glossy ? "diffuseFactor" : "baseColorFactor"))
    material.opacity = static_cast<float>(factor->numbers(4, kUnit)[3]);
  material.opacity_texture =
      texture(*pbr, glossy ? "diffuseTexture" : "baseColorTexture", TextureUse::alpha, "alpha");
}

void Reader::relief() {
  const auto info = json.find("normalTexture");
  if (!info) return;
  material.normal_texture = texture(json, "normalTexture", TextureUse::numbers, "normals",
                                    {"index", "texCoord", "scale"});
  material.normal_scale = number(*info, "scale", 1, kAnyNumber);
}

void Reader::note_others() {
  if (json.find("occlusionTexture"))
    leave_out("occlusion maps are left out, the paths find it themselves");
}

Material Reader::convert() {
  load.check_keys(json,
                  {"pbrMetallicRoughness", "normalTexture", "occlusionTexture", "emissiveTexture",
                   "emissiveFactor", "alphaMode", "alphaCutoff", "doubleSided"});
  material.name = gltf_name(json, "material", index);
  material.kind = MaterialKind::coat;
  material.reflectance = Rgb(1);  // glTF's values for what is not said
  material.roughness = material.metalness = 1;
  const auto both = json.find("doubleSided");
  material.two_sided = material.emits_two_sided = both && both->boolean();
  dielectric();
  if (const auto extension = find_extension(json, "KHR_materials_pbrSpecularGlossiness")) {
    specular_glossiness(*extension);
  } else if (const auto pbr = json.find("pbrMetallicRoughness")) {
    metallic_roughness(*pbr);
  }
  emission();
  if (const auto extension = find_extension(json, "KHR_materials_transmission"))
    transmission(*extension);
  if (find_extension(json, "KHR_materials_unlit")) unlit();
  if (const auto extension = find_extension(json, "KHR_materials_clearcoat")) clearcoat(*extension);
  alpha();
  relief();
  note_others();
  return std::move(material);
}

}  // namespace

void add_gltf_materials(GltfLoad& load) {
  load.first_material = static_cast<int>(load.scene.materials.size());
  const auto materials = load.root().items("materials");
  for (std::size_t i = 0; i < materials.size(); ++i) {
    Reader reader{load, materials[i], i, gltf_place(materials[i])};
    load.scene.materials.push_back(reader.convert());
    load.coordinates.push_back(reader.coordinates.value_or(GltfCoordinates{}));
  }
}

int gltf_material(GltfLoad& load, const JsonCursor& primitive) {
  if (const auto index = primitive.find("material")) {
    (void)load.element("materials", *index, "material");
    return load.first_material + static_cast<int>(index->whole());
  }
  if (load.default_material == kNone) {
    Material plain;  // that of the glTF specification
    plain.name = "default";
    plain.kind = MaterialKind::coat;
    plain.reflectance = Rgb(1);
    plain.roughness = plain.metalness = 1;
    plain.two_sided = false;
    load.default_material = static_cast<int>(load.scene.materials.size());
    load.scene.materials.push_back(plain);
  }
  return load.default_material;
}

}  // namespace psf::render
