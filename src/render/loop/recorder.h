// Keeps the records of one slab of paths as columns of the path-vertex buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "film/film.h"
#include "formats/layout/head.h"
#include "formats/read/reader.h"
#include "render/light/integrator.h"

namespace psf::render {

constexpr std::uint8_t kHasVertexFlag = 1;  // bits of the channel `flags`
constexpr std::uint8_t kShadedFlag = 2;
constexpr const char* kRestPosition = "rest_position";  // a channel for which scenes keep more

// Names that stand for channels.
constexpr const char* kDefaultChannels = "default";
constexpr const char* kAllChannels = "all";

// The channels to write, in the format's order: those that the format requires; `flags` and
// `unfiltered`, without which pictures cannot be made; and of the others those in `optional`, where
// "default" stands for those that files have unless told otherwise, and "all" for every one; empty:
// "default", to which `kind` belongs where vertices can be in volumes. Then those of the layers of
// the light. Throws Error{usage} that names an unknown channel and the known ones.
[[nodiscard]] std::vector<formats::Channel> record_channels(
    std::span<const std::string> optional = {}, std::span<const LayerInfo> layers = {},
    bool has_volumes = false);

// Where a path begins, as the channels of these names have it.
struct CameraSample {
  Vec2 film{0, 0};  // pixels
  Vec2 lens{0, 0};  // of the unit disk
  float time = 0;
  std::uint32_t frame = 0;
};

// Whether any of the channels is one of CameraSample.
[[nodiscard]] bool has_sample(std::span<const formats::Channel> channels);

class Recorder {
 public:
  // `layers`: those of the light that the records will have. `channels`: from record_channels();
  // those that are not among the default ones take room only where they are named here.
  explicit Recorder(std::size_t capacity, std::span<const LayerInfo> layers = {},
                    std::span<const formats::Channel> channels = {});

  // Sets record `slot` < capacity. Different slots may be set from different threads at once.
  // `sums`: as the layers are numbered.
  void set(std::size_t slot, std::uint16_t camera, std::uint32_t pixel, const PathRecord& record,
           const LayerSums& sums = {});
  // Sets what record `slot` has of CameraSample, as far as there is room for it. Thread-safe like
  // set().
  void set_sample(std::size_t slot, const CameraSample& sample);

  // The address of the first value of each channel, for formats::Writer::append(). `channels` are
  // from record_channels(), as given to the constructor. Valid as long as the recorder exists.
  [[nodiscard]] std::vector<const void*> columns(std::span<const formats::Channel> channels) const;

  // Sets the first `count` slots to the records from `first` on of a dump with record_channels(),
  // but only the channels that add_to() needs. Throws what the reader throws.
  void load(const formats::Reader& reader, std::uint64_t first, std::size_t count);

  // Adds u + alpha c of the first `count` records to `film`, in order. With `shade_rate` > 1 only
  // records with the flag for shaded paths are added, with or without a vertex, so that paths that
  // meet no surface do not weigh more than others. Values that are not finite are left out; returns
  // their number.
  std::uint64_t add_to(film::Film& film, std::size_t count, std::uint32_t shade_rate) const;

 private:
  friend struct ColumnTable;
  std::vector<Vec3> position_, normal_, direction_;
  std::vector<Rgb> reflectance_, throughput_, contribution_, unfiltered_;
  std::vector<float> distance_, hit_distance_, roughness_;
  std::vector<std::uint32_t> pixel_, visibility_, material_;
  std::vector<std::uint16_t> camera_;
  std::vector<std::uint8_t> flags_;
  // Of channels that are not among the default ones; empty where they were not asked for.
  std::vector<Vec2> film_, lens_;
  std::vector<float> time_, coverage_;
  std::vector<std::uint32_t> frame_;
  std::vector<VertexKind> kind_;
  std::vector<Vec3> rest_;
  // A channel of a layer, and the layer's number.
  struct LayerColumn {
    std::string channel;
    std::span<Rgb> LayerSums::*part;
    std::size_t layer;
    std::vector<Rgb> values;
  };
  std::vector<LayerColumn> layers_;
};

}  // namespace psf::render
