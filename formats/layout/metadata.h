// The metadata that psf itself writes and understands, as a struct.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace psf::formats {

struct CameraInfo {
  std::string name;
  std::uint32_t width = 0, height = 0;  // pixels
  double angle_per_pixel = 0;           // radians, at the centre of the picture
  std::array<double, 16>
      camera_to_world{};                // row-major, column vectors; camera looks along -z, y up
  std::array<double, 16> projection{};  // camera space to clip space, row-major, column vectors
  bool operator==(const CameraInfo&) const = default;
};

// The frames of a sequence: pass p of the file is of frame first + p / passes, rounded down.
struct FrameInfo {
  std::uint32_t first = 0, count = 1;
  std::uint64_t passes = 1;  // of each frame
  // By frame, in the order of Metadata::cameras; empty: the cameras are those at all frames. Names
  // and sizes are the same at all of them.
  std::vector<std::vector<CameraInfo>> cameras;
};

struct Metadata {
  std::string producer;    // program and version
  std::string scene;       // file name without folder
  std::string scene_hash;  // over everything that shapes the picture
  std::string integrator;  // path, direct, vpl, photon, ao, ...
  std::string sampler;     // sobol, halton, independent
  // "pixel" (a pass visits pixels in order) or "global" (one sequence over the image plane).
  std::string enumeration;
  std::uint64_t seed = 0;
  std::uint32_t block_base = 2;  // b: blocks of b^m contiguous paths are well distributed
  std::uint32_t split = 1;       // continuations averaged into each contribution
  // Above 1: one path in `shade_rate` is shaded, whatever it meets; `flags` says so for records
  // without vertex too.
  std::uint32_t shade_rate = 1;
  double vertex_roughness = 0;      // x_i is the first vertex with at least this roughness
  std::string vertex_rule;          // the same in words
  std::string units;                // unit of lengths, "scene" where unknown
  std::vector<CameraInfo> cameras;  // index = value of the channel `camera`
  std::vector<std::string> lights;  // light l owns bit l mod 32 of the channel `visibility`
  // In words, which lights were tested at x_i; empty: all.
  std::string visibility_rule;
  // Names; index = value of the channel `material`.
  std::vector<std::string> materials;
  std::optional<FrameInfo> frames;  // where the file has frames
};

[[nodiscard]] std::string to_json(const Metadata& metadata);
// Unknown keys are ignored, missing ones keep their defaults; a key of the wrong type or text that
// is no JSON object throws Error{bad_input} naming the key (the caller adds the file).
[[nodiscard]] Metadata parse_metadata(const std::string& json);

}  // namespace psf::formats
