// Materials and textures of a glTF file. The mapping is documented in sample_data/README.md.
#include <fmt/format.h>

#include <array>

#include "formats/error.h"
#include "render/gltf_parts.h"

namespace psf::render {
namespace {

Rgb to_rgb(const std::vector<double>& v, float otherwise) {
  const auto at = [&](std::size_t i) {
    return i < v.size() ? static_cast<float>(v[i]) : otherwise;
  };
  return {at(0), at(1), at(2)};
}

// The percent escapes of a URI, as file names have them.
std::string decode_uri(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() &&
                        std::isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
                        std::isxdigit(static_cast<unsigned char>(uri[i + 2]));
    if (escape) {
      text += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

// Index in Scene::textures of what a TextureInfo names, kNone for nothing.
int texture_of(GltfLoad& load, int texture, ColorSpace color_space, const std::string& wanted_by) {
  if (texture < 0) return kNone;
  const tinygltf::Model& model = load.model;
  const auto fail = [&](const std::string& what) { load.fail(wanted_by, what); };
  if (static_cast<std::size_t>(texture) >= model.textures.size())
    fail(fmt::format("there is no texture {}", texture));
  const tinygltf::Texture& gltf = model.textures[static_cast<std::size_t>(texture)];
  if (gltf.source < 0 || static_cast<std::size_t>(gltf.source) >= model.images.size()) {
    fail(fmt::format("texture {} has no picture that psf reads", texture));
  }
  if (gltf.sampler >= 0 && static_cast<std::size_t>(gltf.sampler) < model.samplers.size()) {
    const tinygltf::Sampler& sampler = model.samplers[static_cast<std::size_t>(gltf.sampler)];
    if (sampler.wrapS != TINYGLTF_TEXTURE_WRAP_REPEAT ||
        sampler.wrapT != TINYGLTF_TEXTURE_WRAP_REPEAT) {
      load.warn_once("textures that clamp or mirror at their edge repeat instead");
    }
  }
  const auto image_index = static_cast<std::size_t>(gltf.source);
  int& known = load.images[image_index][color_space == ColorSpace::srgb ? 0 : 1];
  if (known != kNone) return known;
  const tinygltf::Image& image = model.images[image_index];
  const std::string place = fmt::format("{}: image {}", wanted_by, image_index);
  std::span<const unsigned char> bytes(image.image);
  if (image.bufferView >= 0) bytes = bytes_of(load, image.bufferView, place);
  if (bytes.empty()) {
    if (image.uri.empty()) fail(fmt::format("image {} is empty", image_index));
    known =
        load.files.load(load.path, decode_uri(image.uri), color_space, load.path + ": " + place);
  } else {
    load.scene.textures.push_back(Texture::decode(bytes, load.path + ": " + place, color_space));
    known = static_cast<int>(load.scene.textures.size()) - 1;
  }
  return known;
}

Material convert(GltfLoad& load, const tinygltf::Material& gltf, std::size_t index) {
  const auto& pbr = gltf.pbrMetallicRoughness;
  Material material;
  material.name = gltf.name.empty() ? fmt::format("material {}", index) : gltf.name;
  const std::string place = fmt::format("/materials/{} ({})", index, material.name);
  material.kind = MaterialKind::coat;
  material.two_sided = material.emits_two_sided = gltf.doubleSided;
  material.reflectance = to_rgb(pbr.baseColorFactor, 1);
  material.roughness = static_cast<float>(pbr.roughnessFactor);
  material.metalness = static_cast<float>(pbr.metallicFactor);
  material.emission = to_rgb(gltf.emissiveFactor, 0);
  if (const auto* strength = find_extension(gltf.extensions, "KHR_materials_emissive_strength")) {
    material.emission *= static_cast<float>(number_or(*strength, "emissiveStrength", 1));
  }
  if (const auto* ior = find_extension(gltf.extensions, "KHR_materials_ior")) {
    material.ior = static_cast<float>(number_or(*ior, "ior", 1.5));
  }
  if (const auto* transmission = find_extension(gltf.extensions, "KHR_materials_transmission")) {
    if (number_or(*transmission, "transmissionFactor", 0) > 0.5) {
      if (material.roughness < 0.3f) {
        material.kind = MaterialKind::glass;
      } else {
        load.warn_once("rough transmission is left out, such materials are opaque");
      }
    }
  }
  if (gltf.alphaMode != "OPAQUE" && !gltf.alphaMode.empty()) {
    load.warn_once("alpha is left out, materials are opaque");
  }
  if (gltf.normalTexture.index >= 0) load.warn_once("normal maps are left out");
  material.reflectance_texture =
      texture_of(load, pbr.baseColorTexture.index, ColorSpace::srgb, place + ": base colour");
  material.roughness_metalness_texture = texture_of(
      load, pbr.metallicRoughnessTexture.index, ColorSpace::linear, place + ": metallic-roughness");
  material.emission_texture =
      texture_of(load, gltf.emissiveTexture.index, ColorSpace::srgb, place + ": emission");
  return material;
}

}  // namespace

const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

double number_or(const tinygltf::Value& object, const char* key, double otherwise) {
  if (!object.Has(key) || !object.Get(key).IsNumber()) return otherwise;
  return object.Get(key).GetNumberAsDouble();
}

void add_gltf_materials(GltfLoad& load) {
  load.images.assign(load.model.images.size(), {kNone, kNone});
  load.first_material = static_cast<int>(load.scene.materials.size());
  for (std::size_t i = 0; i < load.model.materials.size(); ++i) {
    load.scene.materials.push_back(convert(load, load.model.materials[i], i));
  }
}

int gltf_material(GltfLoad& load, int material, const std::string& place) {
  if (material >= 0) {
    if (static_cast<std::size_t>(material) >= load.model.materials.size()) {
      load.fail(place, fmt::format("there is no material {}", material));
    }
    return load.first_material + material;
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
