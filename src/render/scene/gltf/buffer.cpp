// Bytes that a glTF file names: URIs, buffers and buffer views.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>

#include "core/error.h"
#include "render/scene/gltf/parts.h"
#include "render/scene/whole_file.h"

namespace psf::render {
namespace {

namespace fs = std::filesystem;

std::string decode_percent(const std::string& uri) {
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

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;  // the latter as in base64url
  return c == '/' || c == '_' ? 63 : -1;
}

std::vector<unsigned char> decode_base64(const JsonCursor& uri, std::string_view text) {
  std::vector<unsigned char> bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (std::size_t i = 0; i < text.size() && text[i] != '='; ++i) {
    if (std::isspace(static_cast<unsigned char>(text[i]))) continue;
    const int digit = base64_digit(text[i]);
    if (digit < 0) {
      uri.fail(fmt::format("{}: character {} of the data is none of base64", brief_uri(uri.text()),
                           i + 1));
    }
    bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFFF;
    count += 6;
    if (count >= 8) bytes.push_back(static_cast<unsigned char>(bits >> (count -= 8) & 255));
  }
  return bytes;
}

std::vector<unsigned char> read_file(const JsonCursor& uri, const std::string& path) {
  try {
    return read_whole<std::vector<unsigned char>>(path);
  } catch (const Error& error) {
    throw Error(error.code(), uri.where() + ": " + error.what());
  }
}

const std::vector<unsigned char>& buffer_of(GltfLoad& load, const JsonCursor& index) {
  const JsonCursor buffer = load.element("buffers", index, "buffer");
  const auto [known, is_new] = load.buffers.try_emplace(static_cast<std::size_t>(index.whole()));
  if (!is_new) return known->second;
  load.check_keys(buffer, {"uri", "byteLength"});
  const std::uint64_t length = buffer.at("byteLength").whole();
  const auto uri = buffer.find("uri");
  if (uri) {
    const std::string text = uri->text();
    if (is_data_uri(text)) {
      known->second = decode_data_uri(*uri);
    } else {
      load.scene.files.push_back(file_of_uri(load, *uri));
      known->second = read_file(*uri, load.scene.files.back());
    }
  } else if (index.whole() == 0 && !load.chunk.empty()) {
    known->second = std::move(load.chunk);
  } else {
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      if (find_extension(buffer, name))
        buffer.fail(fmt::format("needs {}, which psf does not have; export it without", name));
    }
    buffer.fail("has no \"uri\", and the file has no binary chunk for it");
  }
  if (known->second.size() < length) {
    const std::string from = uri ? brief_uri(uri->text()) : std::string("the binary chunk");
    buffer.fail(
        fmt::format("\"byteLength\" is {}, {} has {} bytes", length, from, known->second.size()));
  }
  known->second.resize(static_cast<std::size_t>(length));
  return known->second;
}

}  // namespace

bool is_data_uri(const std::string& uri) {
  return uri.starts_with("data:");
}

std::string brief_uri(const std::string& uri) {
  constexpr std::size_t kMost = 80;
  if (is_data_uri(uri)) {
    const std::string kind = uri.substr(5, std::min(kMost, uri.find_first_of(";,")) - 5);
    return "a data URI" + (kind.empty() ? "" : " of " + kind);
  }
  return uri.size() <= kMost ? uri : uri.substr(0, kMost) + "...";
}

std::vector<unsigned char> decode_data_uri(const JsonCursor& uri) {
  const std::string text = uri.text();
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) uri.fail(brief_uri(text) + " has no comma before its data");
  const std::string_view head = std::string_view(text).substr(0, comma);
  const std::string_view data = std::string_view(text).substr(comma + 1);
  if (head.ends_with(";base64")) return decode_base64(uri, data);
  const std::string bytes = decode_percent(std::string(data));
  return {bytes.begin(), bytes.end()};
}

std::string file_of_uri(const GltfLoad& load, const JsonCursor& uri) {
  const std::string text = uri.text();
  if (text.find("://") != std::string::npos)
    uri.fail(brief_uri(text) + " is no file beside this one; psf reads no network");
  const std::string decoded = decode_percent(text);
  if (decoded.empty() || decoded.find('\0') != std::string::npos)
    uri.fail("\"" + brief_uri(text) + "\" is no name of a file");
  std::string path = find_file(load.path, decoded);
  std::error_code ignored;
  if (fs::exists(path, ignored)) return path;
  const std::string as_written = find_file(load.path, text);  // a name with a % in it, not escaped
  return fs::exists(as_written, ignored) ? as_written : path;
}

std::span<const unsigned char> bytes_of(GltfLoad& load, const JsonCursor& buffer_view) {
  const JsonCursor view = load.element("bufferViews", buffer_view, "bufferView");
  load.check_keys(view, {"buffer", "byteOffset", "byteLength", "byteStride", "target"});
  const auto offset_json = view.find("byteOffset");
  const std::uint64_t offset = offset_json ? offset_json->whole() : 0;
  const std::uint64_t length = view.at("byteLength").whole();
  const JsonCursor index = view.at("buffer");
  const auto& data = buffer_of(load, index);
  if (offset > data.size() || length > data.size() - offset) {
    view.fail(fmt::format("bytes {} to {} reach outside buffer {}, which has {}", offset,
                          offset + length, index.whole(), data.size()));
  }
  return std::span(data).subspan(static_cast<std::size_t>(offset),
                                 static_cast<std::size_t>(length));
}

}  // namespace psf::render
