// Textures of a glTF file: which picture, and which coordinates.
#include <fmt/format.h>

#include <filesystem>

#include "core/error.h"
#include "render/scene/gltf/parts.h"

namespace psf::render {
namespace {

constexpr std::uint64_t kNearest = 9728, kRepeat = 10497;

void note_sampler(GltfLoad& load, const JsonCursor& index, const std::string& wanted_by) {
  const JsonCursor sampler = load.element("samplers", index, "sampler");
  load.check_keys(sampler, {"magFilter", "minFilter", "wrapS", "wrapT"});
  for (const char* key : {"wrapS", "wrapT"}) {
    const auto wrap = sampler.find(key);
    if (wrap && wrap->whole() != kRepeat)
      load.leave_out("textures that clamp or mirror at their edge repeat instead", wanted_by);
  }
  const auto filter = sampler.find("magFilter");
  if (filter && filter->whole() == kNearest)
    load.leave_out("textures that show the nearest texel are interpolated", wanted_by);
}

// Index in Scene::textures; kNone where there is no reader for the picture, which `why` then tells.
int load_image(GltfLoad& load, const JsonCursor& index, TextureUse use,
               const std::string& wanted_by, std::string& why) {
  const JsonCursor image = load.element("images", index, "image");
  const auto key = std::pair(static_cast<std::size_t>(index.whole()), use);
  const auto known = load.images.find(key);
  if (known != load.images.end() && known->second != kNone) return known->second;
  load.check_keys(image, {"uri", "mimeType", "bufferView"});
  const std::string name = fmt::format("{}: {}: image {}", load.path, wanted_by, index.whole());
  const auto uri = image.find("uri"), view = image.find("bufferView");
  std::vector<unsigned char> decoded;
  std::span<const unsigned char> bytes;
  std::string file;
  if (view) {
    bytes = bytes_of(load, *view);
  } else if (!uri) {
    image.fail("has neither \"uri\" nor \"bufferView\"");
  } else if (is_data_uri(uri->text())) {
    decoded = decode_data_uri(*uri);
    bytes = decoded;
  } else {
    file = file_of_uri(load, *uri);
  }
  if (file.empty() && bytes.empty()) throw Error(ErrorCode::bad_input, name + " is empty");
  std::error_code ignored;
  if (!file.empty()) load.scene.files.push_back(file);
  if (!file.empty() && !std::filesystem::exists(file, ignored))
    throw Error(ErrorCode::io, fmt::format("{}: {}: no such picture", name, file));
  why = Texture::why_unreadable(file, bytes);
  int& result = load.images[key];
  result = kNone;
  if (!why.empty()) {
    why = fmt::format(
        "image {}, {}: {}", index.whole(),
        uri ? brief_uri(uri->text()) : "of bufferView " + std::to_string(view->whole()), why);
    return kNone;
  }
  auto& notes = load.scene.warnings;
  load.scene.textures.push_back(file.empty() ? Texture::decode(bytes, name, use, notes, true)
                                             : Texture::load(file, use, notes, true));
  return result = static_cast<int>(load.scene.textures.size()) - 1;
}

}  // namespace

int gltf_texture(GltfLoad& load, const JsonCursor& info, TextureUse use,
                 const std::string& wanted_by) {
  if (load.scene.moment.parts != Moment::Parts::all) return kNone;
  const JsonCursor texture = load.element("textures", info.at("index"), "texture");
  load.check_keys(texture, {"sampler", "source"});
  if (const auto sampler = texture.find("sampler")) note_sampler(load, *sampler, wanted_by);
  // The plain picture first: it is what others stand for in fewer bytes.
  std::vector<JsonCursor> sources;
  if (const auto source = texture.find("source")) sources.push_back(*source);
  for (const char* name :
       {"EXT_texture_webp", "MSFT_texture_dds", "EXT_texture_avif", "KHR_texture_basisu"}) {
    const auto extension = find_extension(texture, name);
    const auto source = extension ? extension->find("source") : std::nullopt;
    if (source) sources.push_back(*source);
  }
  std::string problem;
  for (const JsonCursor& source : sources) {
    std::string why;
    const int found = load_image(load, source, use, wanted_by, why);
    if (found != kNone) return found;
    if (problem.empty()) problem = why;
  }
  if (sources.empty()) problem = texture.path() + " names none";
  load.leave_out("a picture cannot be had and is left out (" + problem + ")", wanted_by);
  return kNone;
}

GltfCoordinates gltf_coordinates(GltfLoad& load, const JsonCursor& info) {
  GltfCoordinates c;
  const auto set = info.find("texCoord");
  if (set) c.set = set->whole();
  const auto transform = find_extension(info, "KHR_texture_transform");
  if (!transform) return c;
  load.check_keys(*transform, {"offset", "rotation", "scale", "texCoord"});
  if (const auto other = transform->find("texCoord")) c.set = other->whole();
  if (const auto offset = transform->find("offset")) c.offset = offset->vec2();
  if (const auto rotation = transform->find("rotation")) c.rotation = rotation->number();
  if (const auto scale = transform->find("scale")) c.scale = scale->vec2();
  return c;
}

}  // namespace psf::render
