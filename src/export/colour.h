// The colour of each point of a cloud, 8 bits, from a channel.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/vec.h"
#include "export/records.h"

namespace psf::exports {

// The colour depends on the channel: `reflectance` and `roughness` are sRGB-encoded; `normal`,
// `direction` and octahedral vectors become (v + 1) / 2; each whole number has a colour of its own;
// all other floats, one as grey or three as red, green and blue, are multiplied by 2^stops,
// tone-mapped and sRGB-encoded like PNG pictures (film/display.h). NaN is black.
class PointColours {
 public:
  // `name`: a channel or `radiance`. Throws Error{bad_input} where the file lacks the channel or it
  // cannot become a colour.
  PointColours(const ExportRecords& records, const std::string& name);

  // Reads the selected records [first, first + count).
  void read(std::uint64_t first, std::size_t count);
  [[nodiscard]] std::array<std::uint8_t, 3> at(std::size_t k) const;

  // Whether the colours depend on the exposure.
  [[nodiscard]] bool is_exposed() const { return kind_ == Kind::exposed; }
  [[nodiscard]] Rgb linear(std::size_t k) const;  // before exposure
  void set_exposure(float stops);
  // The bytes that a record takes in memory.
  [[nodiscard]] std::size_t bytes() const;

 private:
  enum class Kind { exposed, albedo, direction, number };

  const ExportRecords& records_;
  Kind kind_ = Kind::exposed;
  std::size_t channel_ = 0, components_ = 3;
  bool radiance_ = false;
  std::optional<std::size_t> throughput_, unfiltered_;
  float scale_ = 1;
  std::vector<float> values_, throughputs_, unfiltereds_;
  std::vector<std::byte> numbers_;
};

}  // namespace psf::exports
