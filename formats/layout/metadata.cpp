#include "formats/layout/metadata.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace psf::formats {
namespace {

// Sorted by key for reading: the ordered kind looks through all keys for each, which for a MiB of
// them takes many seconds.
using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

// Objects and arrays within each other. Whoever writes JSON again recurses as deep.
constexpr int kMaxDepth = 64;

// One JSON value and the pointer to it, for messages.
struct Place {
  const Json& value;
  std::string pointer;

  [[noreturn]] void fail(const char* expected) const {
    throw Error(ErrorCode::bad_input, fmt::format("metadata: {}: expected {}",
                                                  pointer.empty() ? "/" : pointer, expected));
  }
  [[nodiscard]] Place element(std::size_t k) const {
    return {value[k], fmt::format("{}/{}", pointer, k)};
  }
};

void read(const Place& place, std::string& out) {
  if (!place.value.is_string()) place.fail("a string");
  out = place.value.get<std::string>();
}

void read(const Place& place, double& out) {
  if (!place.value.is_number()) place.fail("a number");
  out = place.value.get<double>();
}

void read(const Place& place, std::uint64_t& out) {
  if (!place.value.is_number_unsigned()) place.fail("a whole number from 0 to 2^64 - 1");
  out = place.value.get<std::uint64_t>();
}

void read(const Place& place, std::uint32_t& out) {
  constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();
  if (!place.value.is_number_unsigned() || place.value.get<std::uint64_t>() > kMost) {
    place.fail("a whole number from 0 to 2^32 - 1");
  }
  out = place.value.get<std::uint32_t>();
}

void read(const Place& place, std::array<double, 16>& out) {
  if (!place.value.is_array() || place.value.size() != out.size()) place.fail("16 numbers");
  for (std::size_t k = 0; k < out.size(); ++k) read(place.element(k), out[k]);
}

void read(const Place& place, CameraInfo& out);

template <class T>
void read(const Place& place, std::vector<T>& out) {
  if (!place.value.is_array()) place.fail("an array");
  out.resize(place.value.size());
  for (std::size_t k = 0; k < out.size(); ++k) read(place.element(k), out[k]);
}

// A missing key keeps what `out` holds.
template <class T>
void read_key(const Place& object, const char* key, T& out) {
  const auto found = object.value.find(key);
  if (found != object.value.end()) read({*found, object.pointer + "/" + key}, out);
}

void read(const Place& place, CameraInfo& out) {
  if (!place.value.is_object()) place.fail("an object");
  read_key(place, "name", out.name);
  read_key(place, "width", out.width);
  read_key(place, "height", out.height);
  read_key(place, "angle_per_pixel", out.angle_per_pixel);
  read_key(place, "camera_to_world", out.camera_to_world);
  read_key(place, "projection", out.projection);
}

OrderedJson camera_json(const CameraInfo& camera) {
  return {{"name", camera.name},
          {"width", camera.width},
          {"height", camera.height},
          {"angle_per_pixel", camera.angle_per_pixel},
          {"camera_to_world", camera.camera_to_world},
          {"projection", camera.projection}};
}

OrderedJson frames_json(const FrameInfo& frames) {
  OrderedJson json = {{"first", frames.first}, {"count", frames.count}, {"passes", frames.passes}};
  if (frames.cameras.empty()) return json;
  OrderedJson all = OrderedJson::array();
  for (const std::vector<CameraInfo>& cameras : frames.cameras) {
    OrderedJson of_frame = OrderedJson::array();
    for (const CameraInfo& camera : cameras) {
      OrderedJson entry = camera_json(camera);
      for (const char* same : {"name", "width", "height"}) entry.erase(same);
      of_frame.push_back(std::move(entry));
    }
    all.push_back(std::move(of_frame));
  }
  json["cameras"] = std::move(all);
  return json;
}

// `cameras`: those of the file.
void read_frames(const Place& place, const std::vector<CameraInfo>& cameras, FrameInfo& out) {
  if (!place.value.is_object()) place.fail("an object");
  read_key(place, "first", out.first);
  read_key(place, "count", out.count);
  read_key(place, "passes", out.passes);
  constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
  if (out.count == 0 || out.passes == 0 || out.passes >= kMost ||
      out.first + std::uint64_t{out.count} > kMost) {
    place.fail("a \"count\" and \"passes\" of at least 1, and frames and passes below 2^32");
  }
  read_key(place, "cameras", out.cameras);
  if (out.cameras.empty()) return;
  const Place all{place.value.at("cameras"), place.pointer + "/cameras"};
  if (out.cameras.size() != out.count) all.fail("an entry for each frame");
  for (std::size_t k = 0; k < out.cameras.size(); ++k) {
    if (out.cameras[k].size() != cameras.size()) all.element(k).fail("all cameras of the file");
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      CameraInfo& camera = out.cameras[k][c];
      camera.name = cameras[c].name;
      camera.width = cameras[c].width;
      camera.height = cameras[c].height;
    }
  }
}

// Before parsing: the parser's own callback takes quadratic time.
void check_depth(const std::string& json) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t k = 0; k < json.size(); ++k) {
    const char c = json[k];
    if (c == '"') quoted = !quoted;
    if (quoted) {
      if (c == '\\') ++k;
      continue;
    }
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kMaxDepth) {
      throw Error(
          ErrorCode::limit,
          fmt::format("metadata: more than {} objects or arrays within each other", kMaxDepth));
    }
  }
}

}  // namespace

std::string to_json(const Metadata& metadata) {
  OrderedJson cameras = OrderedJson::array();
  for (const CameraInfo& camera : metadata.cameras) cameras.push_back(camera_json(camera));
  OrderedJson json = {{"producer", metadata.producer},
                      {"scene", metadata.scene},
                      {"scene_hash", metadata.scene_hash},
                      {"integrator", metadata.integrator},
                      {"sampler", metadata.sampler},
                      {"enumeration", metadata.enumeration},
                      {"seed", metadata.seed},
                      {"block_base", metadata.block_base},
                      {"split", metadata.split},
                      {"vertex_roughness", metadata.vertex_roughness},
                      {"vertex_rule", metadata.vertex_rule},
                      {"units", metadata.units},
                      {"cameras", std::move(cameras)},
                      {"lights", metadata.lights}};
  if (!metadata.visibility_rule.empty()) json["visibility_rule"] = metadata.visibility_rule;
  if (!metadata.materials.empty()) json["materials"] = metadata.materials;
  if (metadata.frames) json["frames"] = frames_json(*metadata.frames);
  if (metadata.shade_rate > 1) json["shade_rate"] = metadata.shade_rate;
  // A name that is not UTF-8 (a file name may be any bytes) is stored with U+FFFD in it.
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

Metadata parse_metadata(const std::string& json) {
  check_depth(json);
  const Json root = Json::parse(json, nullptr, false);
  if (!root.is_object()) {
    throw Error(ErrorCode::bad_input, "metadata: expected a JSON object in UTF-8");
  }
  const Place place{root, ""};
  Metadata out;
  read_key(place, "producer", out.producer);
  read_key(place, "scene", out.scene);
  read_key(place, "scene_hash", out.scene_hash);
  read_key(place, "integrator", out.integrator);
  read_key(place, "sampler", out.sampler);
  read_key(place, "enumeration", out.enumeration);
  read_key(place, "seed", out.seed);
  read_key(place, "block_base", out.block_base);
  read_key(place, "split", out.split);
  read_key(place, "shade_rate", out.shade_rate);
  read_key(place, "vertex_roughness", out.vertex_roughness);
  read_key(place, "vertex_rule", out.vertex_rule);
  read_key(place, "units", out.units);
  read_key(place, "cameras", out.cameras);
  read_key(place, "lights", out.lights);
  read_key(place, "visibility_rule", out.visibility_rule);
  read_key(place, "materials", out.materials);
  if (const auto found = root.find("frames"); found != root.end()) {
    read_frames({*found, "/frames"}, out.cameras, out.frames.emplace());
  }
  return out;
}

}  // namespace psf::formats
