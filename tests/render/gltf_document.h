// glTF files that the tests write themselves, one buffer each.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace psf::render {

using nlohmann::json;

inline std::string base64(const std::string& bytes) {
  static const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? kDigits[(group >> (18 - 6 * k)) & 63] : '=';
    }
  }
  return text;
}

inline std::string decode_base64(const std::string& text) {
  static const std::string kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0, count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(kDigits.find(c));
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255);
  }
  return bytes;
}

// A PNG of one texel, 188 188 188.
inline const std::string kPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mPYs2cPAARsAjVdEe8gAAAAAElFTkSuQmCC";

// A glTF document that grows, with one buffer.
struct Document {
  json root = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
  std::string buffer;

  template <typename T>
  int accessor(const std::vector<T>& values, int component_type, const char* type,
               std::size_t components, std::size_t stride = 0) {
    while (buffer.size() % 4 != 0) buffer += '\0';
    const std::size_t offset = buffer.size(), element = components * sizeof(T);
    for (std::size_t i = 0; i < values.size(); i += components) {
      std::string bytes(std::max(stride, element),
                        '\x7f');  // what lies between strided elements is no zero
      std::memcpy(bytes.data(), &values[i], element);
      buffer += bytes;
    }
    json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", buffer.size() - offset}};
    if (stride != 0) view["byteStride"] = stride;
    root["bufferViews"].push_back(view);
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component_type},
                                 {"count", values.size() / components},
                                 {"type", type}});
    return static_cast<int>(root["accessors"].size()) - 1;
  }
  [[nodiscard]] std::string gltf() const {
    json whole = root;
    whole["buffers"] = {{{"byteLength", buffer.size()},
                         {"uri", "data:application/octet-stream;base64," + base64(buffer)}}};
    return whole.dump();
  }
  [[nodiscard]] std::string glb() const {
    json whole = root;
    whole["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string text = whole.dump(), binary = buffer, file = "glTF";
    while (text.size() % 4 != 0) text += ' ';
    while (binary.size() % 4 != 0) binary += '\0';
    const auto add = [&](std::size_t value) {
      const auto word = static_cast<std::uint32_t>(value);
      file.append(reinterpret_cast<const char*>(&word), sizeof word);
    };
    add(2);
    add(12 + 8 + text.size() + 8 + binary.size());
    add(text.size());
    file += "JSON" + text;
    add(binary.size());
    file += std::string("BIN\0", 4) + binary;
    return file;
  }
};

inline const std::vector<float> kTriangle = {0, 0, 0, 1, 0, 0, 0, 2, 0};

// One triangle with float positions, strided, and 16-bit indices, in node 0.
inline Document triangle() {
  Document d;
  const int positions = d.accessor(kTriangle, 5126, "VEC3", 3, 20);
  const int indices = d.accessor(std::vector<std::uint16_t>{0, 1, 2}, 5123, "SCALAR", 1);
  d.root["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}}};
  d.root["nodes"] = {{{"mesh", 0}, {"name", "tri"}}};
  return d;
}

// A triangle with a material.
inline Document with_material(const json& material) {
  Document d = triangle();
  d.root["materials"] = json::array({material});
  d.root["meshes"][0]["primitives"][0]["material"] = 0;
  return d;
}

}  // namespace psf::render
