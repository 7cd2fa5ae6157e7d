// What psf does with the extensions of glTF. The list is that of Khronos's registry: the ratified
// ones and those of several vendors; any other is left out, or refused where the file needs it.
#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "render/scene/gltf/parts.h"

namespace psf::render {
namespace {

enum class Support {
  read,     // with notes of its own where only in part
  no_loss,  // left out, and no still picture is another for it
  left_out  // refused where a file needs it
};

struct Extension {
  std::string_view name;
  Support support;
  std::string_view meaning;  // what an extension that is left out is for
};

constexpr Extension kExtensions[] = {
    {"EXT_mesh_gpu_instancing", Support::read, ""},
    {"EXT_texture_avif", Support::read, ""},
    {"EXT_texture_webp", Support::read, ""},
    {"KHR_lights_punctual", Support::read, ""},
    {"KHR_materials_clearcoat", Support::read, ""},
    {"KHR_materials_emissive_strength", Support::read, ""},
    {"KHR_materials_ior", Support::read, ""},
    {"KHR_materials_pbrSpecularGlossiness", Support::read, ""},
    {"KHR_materials_specular", Support::read, ""},
    {"KHR_materials_transmission", Support::read, ""},
    {"KHR_materials_unlit", Support::read, ""},
    {"KHR_mesh_quantization", Support::read, ""},
    {"KHR_node_visibility", Support::read, ""},
    {"KHR_texture_basisu", Support::read, ""},
    {"KHR_texture_transform", Support::read, ""},
    {"MSFT_texture_dds", Support::read, ""},

    {"KHR_animation_pointer", Support::no_loss, "animations"},
    {"KHR_materials_variants", Support::no_loss, "other materials to choose"},
    {"KHR_node_hoverability", Support::no_loss, "interaction"},
    {"KHR_node_selectability", Support::no_loss, "interaction"},
    {"KHR_xmp", Support::no_loss, "metadata"},
    {"KHR_xmp_json_ld", Support::no_loss, "metadata"},

    {"EXT_lights_ies", Support::left_out, "lights with a profile"},
    {"EXT_lights_image_based", Support::left_out, "an environment; `sky` takes a picture"},
    {"EXT_meshopt_compression", Support::left_out, "compressed geometry"},
    {"KHR_draco_mesh_compression", Support::left_out, "compressed geometry"},
    {"KHR_gaussian_splatting", Support::left_out, "splats"},
    {"KHR_materials_anisotropy", Support::left_out, "highlights that depend on the direction"},
    {"KHR_materials_diffuse_transmission", Support::left_out, "light through thin surfaces"},
    {"KHR_materials_dispersion", Support::left_out, "colours of refraction"},
    {"KHR_materials_iridescence", Support::left_out, "thin films"},
    {"KHR_materials_sheen", Support::left_out, "the sheen of cloth"},
    {"KHR_materials_volume", Support::left_out, "absorption"},
    {"KHR_materials_volume_scatter", Support::left_out, "scattering within bodies"},
    {"KHR_meshopt_compression", Support::left_out, "compressed geometry"},
    {"KHR_techniques_webgl", Support::left_out, "shaders"},
    {"MSFT_lod", Support::left_out, "other levels of detail"},
};

const Extension* find(std::string_view name) {
  const auto found = std::find_if(std::begin(kExtensions), std::end(kExtensions),
                                  [&](const Extension& e) { return e.name == name; });
  return found == std::end(kExtensions) ? nullptr : found;
}

std::string left_out(const std::string& name) {
  const Extension* known = find(name);
  const std::string meaning =
      known == nullptr || known->meaning.empty() ? "" : fmt::format(" ({})", known->meaning);
  return fmt::format("{}{} is left out", brief_uri(name), meaning);
}

bool is_read(const std::string& name) {
  const Extension* known = find(name);
  return known != nullptr && known->support == Support::read;
}

// Every object of the file with extensions. What is within extensions and extras is theirs.
void walk(GltfLoad& load, const JsonCursor& json, std::set<std::string>& met, int depth) {
  constexpr int kDeepest = 16;  // no object of glTF lies deeper
  if (depth > kDeepest) return;
  if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i) walk(load, json.item(i), met, depth + 1);
  } else if (json.is_object()) {
    for (const std::string& key : json.keys()) {
      if (key == "extras") continue;
      const JsonCursor value = *json.find(key);
      if (key != "extensions") {
        walk(load, value, met, depth + 1);
        continue;
      }
      for (const std::string& name : value.keys()) {
        met.insert(name);
        if (!is_read(name)) load.leave_out(left_out(name), gltf_place(json));
      }
    }
  }
}

}  // namespace

void check_gltf_extensions(GltfLoad& load) {
  const JsonCursor root = load.root();
  for (const JsonCursor& item : root.items("extensionsRequired")) {
    const std::string name = item.text();
    const Extension* known = find(name);
    if (known != nullptr && known->support != Support::left_out) continue;
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: /extensionsRequired: the file needs {}, which psf does not have; "
                            "export it without",
                            load.path, brief_uri(name)));
  }
  std::set<std::string> met;
  walk(load, root, met, 0);
  // Some leave no trace in the objects that they change.
  for (const JsonCursor& item : root.items("extensionsUsed")) {
    const std::string name = item.text();
    if (!is_read(name) && !met.contains(name)) load.leave_out(left_out(name), "/extensionsUsed");
  }
}

}  // namespace psf::render
