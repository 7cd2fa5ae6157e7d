// A path-vertex buffer as the filter wants it: cameras, passes, and blocks of the channels that are
// needed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filter/blocks.h"
#include "filter/parameters.h"
#include "formats/metadata.h"
#include "formats/reader.h"
#include "study/block_records.h"

namespace psf::study {

// Channels by their place in the file; not set: not read. What is optional in a dump stands at its
// default: without `flags` every path has a shaded vertex, without `unfiltered` it is 0, without
// `camera` it is camera 0.
struct ChannelSet {
  std::optional<std::size_t> flags, position, distance, throughput, contribution, unfiltered, pixel,
      camera, normal, reflectance, visibility, hit_distance, direction, material, roughness;
};

class Dump {
 public:
  // Throws what formats::Reader throws; Error{bad_input} where there is no committed pass or no
  // camera.
  explicit Dump(const std::string& path);

  // Takes in the passes committed since; true where the file says more than before. Throws what the
  // constructor throws.
  bool refresh();

  [[nodiscard]] const formats::Reader& reader() const { return reader_; }
  [[nodiscard]] const formats::Metadata& metadata() const { return metadata_; }
  [[nodiscard]] const std::vector<filter::CameraView>& cameras() const { return cameras_; }
  [[nodiscard]] std::uint64_t pixels() const { return pixels_; }  // of all cameras
  // First path of each pass, and the end.
  [[nodiscard]] const std::vector<std::uint64_t>& pass_bounds() const { return pass_bounds_; }

  // What the parameters use. With `guides`, normal and reflectance too where the file has them.
  // Throws Error{bad_input} naming the channel that is missing or of another type, and who needs
  // it.
  [[nodiscard]] ChannelSet select(const filter::Parameters& parameters, bool guides) const;

  // Reads paths [range.first, range.last), columns in parallel. Throws Error{bad_input} naming the
  // record whose pixel or camera does not exist. Thread-safe.
  void read(const filter::PathRange& range, const ChannelSet& channels, BlockRecords& out) const;

 private:
  [[nodiscard]] std::optional<std::size_t> find(const char* channel, formats::Type type,
                                                std::size_t components) const;
  [[nodiscard]] std::size_t require(const char* channel, formats::Type type, std::size_t components,
                                    std::string_view wanted_by,
                                    std::string_view instead = {}) const;
  void set_pass_bounds();
  void require_angles() const;
  void check_pixels(const filter::PathRange& range, const BlockRecords& records) const;

  formats::Reader reader_;
  formats::Metadata metadata_;
  std::vector<filter::CameraView> cameras_;
  std::uint64_t pixels_ = 0;
  std::vector<std::uint64_t> pass_bounds_;
};

}  // namespace psf::study
