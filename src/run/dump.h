// Reads a path-vertex buffer for the filter: cameras, passes, and blocks of the channels in use.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "filter/blocks.h"
#include "filter/parameters/parameters.h"
#include "formats/layout/metadata.h"
#include "formats/read/reader.h"
#include "run/block_records.h"
#include "run/light_layers.h"
#include "run/vertex_rule.h"

namespace psf::run {

// The channels to read, by their place in the file; those not set are not read. A channel that a
// dump may lack has a default: without `flags` every path has a shaded vertex, without `unfiltered`
// u is 0, without `camera` every path belongs to camera 0.
struct ChannelSet {
  std::optional<std::size_t> flags, position, distance, throughput, contribution, unfiltered, pixel,
      camera, normal, reflectance, visibility, hit_distance, direction, material, roughness,
      coverage, kind, rest_position;
  std::vector<LightLayer> layers;
  std::optional<PhotonChannels> photons;
};

class Dump {
 public:
  // Throws what formats::Reader throws; Error{bad_input} where there is no committed pass or no
  // camera. With a rule for the vertex also what VertexCut throws: x_i is then another vertex of each
  // path. Without one x_i is what the file says.
  // The cameras are those at `frame`, where the file tells of it.
  explicit Dump(const std::string& path, const std::optional<VertexRule>& rule = {},
                std::optional<std::uint32_t> frame = {});

  // The same file, which stays open as long as one of the two, with another choice of x_i; none:
  // what the file says. Throws what VertexCut throws. What is refreshed is the one that refresh() is
  // called on.
  [[nodiscard]] Dump at(const std::optional<VertexRule>& rule) const;

  // The same file with the cameras at `frame`, where it tells of them.
  [[nodiscard]] Dump of_frame(std::uint32_t frame) const;

  // Takes in what was committed since the file was read; returns whether there was anything new.
  // Throws what the constructor throws.
  bool refresh();

  [[nodiscard]] const formats::Reader& reader() const { return *reader_; }
  [[nodiscard]] const formats::Metadata& metadata() const { return metadata_; }
  [[nodiscard]] const std::vector<filter::CameraView>& cameras() const { return cameras_; }
  [[nodiscard]] std::uint64_t pixels() const { return pixels_; }  // number over all cameras
  // The first path of each pass, and the end of the last one.
  [[nodiscard]] const std::vector<std::uint64_t>& pass_bounds() const { return pass_bounds_; }

  [[nodiscard]] const std::optional<VertexRule>& vertex_rule() const { return rule_; }
  // The most bytes that the choice of the vertex takes beside the records; 0 without a rule.
  [[nodiscard]] std::uint64_t vertex_memory() const;
  // Whether records have a kind that the vertex brings and the paths of the file do not have.
  [[nodiscard]] bool makes_kind() const;
  // Whether the paths have a channel, for the vertex that is chosen.
  [[nodiscard]] bool has(std::string_view channel) const;

  // The channels that `parameters` use; with `guides`, also normal and reflectance where the file
  // has them. Throws Error{bad_input} that names a channel that is missing or has another type, and
  // what needs it, or photons.
  [[nodiscard]] ChannelSet select(const filter::Parameters& parameters, bool guides) const;

  // The place of a channel of formats::kChannels, which has its type; not set where the file has
  // none of this name. Throws Error{bad_input} where it has another type.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view channel) const;

  // The same, where the dump must have it. Throws Error{bad_input} that names `wanted_by` and how to
  // do without, where there is a way.
  [[nodiscard]] std::size_t require(std::string_view channel, std::string_view wanted_by,
                                    std::string_view instead = {}) const;

  // Reads the paths [range.first, range.last), columns in parallel. What of a layer of the light is
  // not finite is 0, of alpha 1, and counted. Throws Error{bad_input} that names a record whose
  // pixel or camera does not exist. Thread-safe.
  void read(const filter::PathRange& range, const ChannelSet& channels, BlockRecords& out) const;

 private:
  void set_cameras(std::optional<std::uint32_t> frame);
  void set_pass_bounds();
  void require_angles() const;
  void check_pixels(const filter::PathRange& range, const BlockRecords& records) const;

  std::shared_ptr<formats::Reader> reader_;
  formats::Metadata metadata_;
  std::vector<filter::CameraView> cameras_;
  std::uint64_t pixels_ = 0;
  std::vector<std::uint64_t> pass_bounds_;
  std::optional<VertexRule> rule_;
};

}  // namespace psf::run
