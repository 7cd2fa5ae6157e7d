// A glTF file as it lies on the disk: JSON, or a GLB of JSON and a binary chunk; its version.
#include "render/scene/json/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "render/scene/gltf/parts.h"
#include "render/scene/whole_file.h"

namespace psf::render {
namespace {

constexpr std::size_t kHeader = 12, kChunkHeader = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t k = 4; k-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[at + k]);
  return word;
}

// The JSON of a GLB; its binary chunk goes to `load`.
std::string read_glb(GltfLoad& load, const std::string& bytes) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::bad_input, load.path + ": " + what);
  };
  if (bytes.size() < kHeader) fail("is cut within the header of a GLB");
  const std::uint32_t version = word_at(bytes, 4), length = word_at(bytes, 8);
  if (version != 2)
    fail(fmt::format("is {} {}.0, psf reads 2.0", version == 1 ? "glTF" : "GLB of glTF", version));
  if (length > bytes.size()) {
    fail(
        fmt::format("is cut: a GLB of {} bytes by its header, {} are there", length, bytes.size()));
  }
  std::string json;
  for (std::size_t at = kHeader, index = 0; at < length; ++index) {
    if (length - at < kChunkHeader) fail(fmt::format("byte {}: a chunk is cut", at));
    const std::size_t size = word_at(bytes, at), type = word_at(bytes, at + 4);
    at += kChunkHeader;
    if (size > length - at)
      fail(fmt::format("byte {}: a chunk of {} bytes does not fit into the file", at, size));
    if (index == 0 && type != kJsonChunk) fail("the first chunk of a GLB is JSON, here it is not");
    if (index == 0) json = bytes.substr(at, size);
    if (index == 1 && type == kBinaryChunk) {
      load.chunk.assign(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                        bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
    }
    at += size;
  }
  if (json.empty()) fail("is a GLB without JSON");
  return json;
}

struct Version {
  int major = 0, minor = 0;
  auto operator<=>(const Version&) const = default;
};
constexpr Version kRead{2, 0};

Version version_of(const JsonCursor& json) {
  const std::string text = json.text();
  Version v;
  const char* const end = text.data() + text.size();
  const auto major = std::from_chars(text.data(), end, v.major);
  const bool dot = major.ec == std::errc() && major.ptr != end && *major.ptr == '.';
  if (!dot || std::from_chars(major.ptr + 1, end, v.minor).ec != std::errc())
    json.expected("a version like \"2.0\"");
  return v;
}

void check_version(const GltfLoad& load) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::bad_input, load.path + ": " + what);
  };
  const JsonCursor root = load.root();
  const auto asset = root.find("asset");
  const auto text = asset ? asset->find("version") : std::nullopt;
  // Version 1.0 had objects where 2.0 has arrays, and files without "asset".
  for (const char* key : {"scenes", "nodes", "meshes", "buffers"}) {
    const auto found = root.find(key);
    if (found && found->is_object() && (!text || version_of(*text).major == 1))
      fail("is glTF 1.0, psf reads 2.0");
  }
  const Version version = version_of(root.at("asset").at("version"));
  if (version.major != kRead.major)
    fail(fmt::format("is glTF {}.{}, psf reads 2.0", version.major, version.minor));
  const auto least = asset->find("minVersion");
  if (least && version_of(*least) > kRead) {
    fail(fmt::format("needs glTF {}.{} (/asset/minVersion), psf reads 2.0",
                     version_of(*least).major, version_of(*least).minor));
  }
}

}  // namespace

void read_gltf_file(GltfLoad& load) {
  auto bytes = read_whole<std::string>(load.path);
  if (bytes.starts_with("glTF")) bytes = read_glb(load, bytes);
  load.document = std::make_shared<const nlohmann::json>(parse_json(std::move(bytes), load.path));
  check_version(load);
}

JsonCursor GltfLoad::element(const char* array, const JsonCursor& index, const char* kind) const {
  const std::uint64_t i = index.whole();
  const auto found = root().find(array);
  if (!found || i >= found->size()) index.fail(fmt::format("there is no {} {}", kind, i));
  return found->item(static_cast<std::size_t>(i));
}

void GltfLoad::leave_out(const std::string& what, const std::string& where) {
  for (Note& note : notes_) {
    if (note.what == what) {
      note.places.insert(where);
      return;
    }
  }
  notes_.push_back({what, where, {where}});
}

void GltfLoad::check_keys(const JsonCursor& object, std::initializer_list<std::string_view> known) {
  for (const std::string& key : object.keys()) {
    if (key == "name" || key == "extras" || key == "extensions") continue;
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    leave_out(fmt::format("the key \"{}\" is not one of glTF's and is left out{}", brief_uri(key),
                          suggestion(key, std::span(known.begin(), known.size()))),
              gltf_place(object));
  }
}

void GltfLoad::tell() {
  for (const Note& note : notes_) {
    std::string line = path + ": " + note.what;
    if (!note.first.empty()) line += ": " + note.first;
    if (note.places.size() > 1) line += fmt::format(" and {} more", note.places.size() - 1);
    scene.warnings.push_back(std::move(line));
  }
  notes_.clear();
}

std::string gltf_place(const JsonCursor& object) {
  const auto name = object.is_object() ? object.find("name") : std::nullopt;
  return name && name->is_text() ? fmt::format("{} ({})", object.path(), name->text())
                                 : object.path();
}

std::string gltf_name(const JsonCursor& object, const char* kind, std::size_t index) {
  const auto name = object.find("name");
  const std::string text = name ? name->text() : std::string();
  return text.empty() ? fmt::format("{} {}", kind, index) : text;
}

std::optional<JsonCursor> find_extension(const JsonCursor& object, const char* name) {
  const auto extensions = object.find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

}  // namespace psf::render
