// The records of one slab of paths as the columns of the path-vertex buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "film/film.h"
#include "formats/head.h"
#include "formats/reader.h"
#include "render/integrator.h"

namespace psf::render {

constexpr std::uint8_t kHasVertexFlag = 1;  // bits of the channel `flags`
constexpr std::uint8_t kShadedFlag = 2;

// The channels to write: those that the format requires and `flags` and `unfiltered`, without which
// pictures cannot be made, then of the rest those in `optional`; empty: all. In the format's order.
// Throws Error{usage} naming an unknown channel and those there are.
[[nodiscard]] std::vector<formats::Channel> record_channels(
    std::span<const std::string> optional = {});

class Recorder {
 public:
  explicit Recorder(std::size_t capacity);

  // Sets record `slot` < capacity. Different slots may be set from different threads at once.
  void set(std::size_t slot, std::uint16_t camera, std::uint32_t pixel, const PathRecord& record);

  // For each channel its first value, as formats::Writer::append wants it. `channels`: of
  // record_channels(). Valid while the recorder lives.
  [[nodiscard]] std::vector<const void*> columns(std::span<const formats::Channel> channels) const;

  // Sets the first `count` slots, as far as add_to() needs them, to records of a dump that has
  // record_channels(), from `first` on. Throws what the reader throws.
  void load(const formats::Reader& reader, std::uint64_t first, std::size_t count);

  // Adds u + alpha * c of the first `count` records, in order; where one path in `shade_rate` > 1
  // is shaded, of those that have the flag, with a vertex or without: of what meets no surface no
  // more is to count than of what does. Non-finite values are left out; returns how many.
  std::uint64_t add_to(film::Film& film, std::size_t count, std::uint32_t shade_rate) const;

 private:
  friend struct ColumnTable;
  std::vector<Vec3> position_, normal_, direction_;
  std::vector<Rgb> reflectance_, throughput_, contribution_, unfiltered_;
  std::vector<float> distance_, hit_distance_, roughness_;
  std::vector<std::uint32_t> pixel_, visibility_, material_;
  std::vector<std::uint16_t> camera_;
  std::vector<std::uint8_t> flags_;
};

}  // namespace psf::render
