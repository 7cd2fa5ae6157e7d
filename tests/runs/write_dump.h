// Writes records of a test as a path-vertex buffer.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "../filter/photon_set.h"
#include "formats/layout/metadata.h"
#include "formats/write/writer.h"

namespace psf::tests {

struct DumpOptions {
  std::vector<filter::CameraView> cameras;
  std::vector<std::size_t> passes;  // records each; they add up to all
  std::vector<std::string> without_channels;
  std::string enumeration = "pixel";
  formats::Codec codec = formats::Codec::zstd;
  std::uint32_t chunk_capacity = 100;
  std::uint32_t shade_rate = 1;
  // Channels of three floats beside those of the records.
  std::vector<std::pair<std::string, const std::vector<Rgb>*>> more = {};
  std::uint8_t components_of_more = 3;
  const std::vector<float>* alpha = nullptr;  // the channel of this name; null: none
  const PhotonSet* photons = nullptr;         // the table, where there is one
  std::vector<std::size_t> photons_of_passes = {};
};

// The table `photons` without what the filter does not look at.
inline formats::Table photon_table() {
  using formats::Encoding;
  using formats::Type;
  formats::Table table;
  table.name = "photons";
  table.chunk_capacity = 64;
  for (const char* name : {"position", "normal", "direction", "power"}) {
    table.channels.push_back({name, Type::f32, 3, Encoding::plain});
  }
  table.channels.push_back({"material", Type::u32, 1, Encoding::plain});
  return table;
}

inline void write_dump(const std::string& path, const RecordSet& set, const DumpOptions& options) {
  formats::Metadata metadata;
  metadata.scene_hash = "abc";
  metadata.seed = 17;
  metadata.enumeration = options.enumeration;
  metadata.shade_rate = options.shade_rate;
  for (const filter::CameraView& camera : options.cameras) {
    formats::CameraInfo info;
    info.name = "camera " + std::to_string(metadata.cameras.size());
    info.width = camera.width;
    info.height = camera.height;
    info.angle_per_pixel = camera.angle_per_pixel;
    metadata.cameras.push_back(info);
  }
  formats::Head head;
  head.metadata = formats::to_json(metadata);
  head.chunk_capacity = options.chunk_capacity;
  struct Source {
    const void* data;
    std::size_t stride;
  };
  std::vector<Source> sources;
  const auto add = [&](const std::string& name, formats::Type type, std::uint8_t components,
                       const void* data) {
    const auto& without = options.without_channels;
    if (std::find(without.begin(), without.end(), name) != without.end()) return;
    head.channels.push_back({name, type, components, formats::Encoding::plain});
    sources.push_back({data, head.channels.back().stride()});
  };
  using formats::Type;
  add("position", Type::f32, 3, set.position.data());
  add("normal", Type::f32, 3, set.normal.data());
  add("reflectance", Type::f32, 3, set.reflectance.data());
  add("throughput", Type::f32, 3, set.throughput.data());
  add("contribution", Type::f32, 3, set.contribution.data());
  add("unfiltered", Type::f32, 3, set.unfiltered.data());
  add("distance", Type::f32, 1, set.distance.data());
  add("pixel", Type::u32, 1, set.pixel.data());
  add("flags", Type::u8, 1, set.flags.data());
  add("camera", Type::u16, 1, set.camera.data());
  add("visibility", Type::u32, 1, set.visibility.data());
  add("hit_distance", Type::f32, 1, set.hit_distance.data());
  add("direction", Type::f32, 3, set.direction.data());
  add("material", Type::u32, 1, set.material.data());
  add("roughness", Type::f32, 1, set.roughness.data());
  if (options.alpha != nullptr) add("alpha", Type::f32, 1, options.alpha->data());
  for (const auto& [name, values] : options.more) {
    add(name, Type::f32, options.components_of_more, values->data());
  }

  if (options.photons != nullptr) head.tables.push_back(photon_table());

  formats::WriterOptions writer_options;
  writer_options.codec = options.codec;
  writer_options.sync = false;
  formats::Writer writer(path, head, writer_options);
  std::size_t first = 0, first_photon = 0, pass = 0;
  for (const std::size_t count : options.passes) {
    if (options.photons != nullptr) {
      const PhotonSet& all = *options.photons;
      const void* const columns[] = {&all.position[first_photon], &all.normal[first_photon],
                                     &all.direction[first_photon], &all.power[first_photon],
                                     &all.material[first_photon]};
      writer.append_to(1, options.photons_of_passes[pass], columns);
      first_photon += options.photons_of_passes[pass++];
    }
    std::vector<const void*> columns;
    for (const Source& source : sources) {
      columns.push_back(static_cast<const char*>(source.data) + first * source.stride);
    }
    writer.append(count, columns);
    writer.commit();
    first += count;
  }
  writer.close();
}

}  // namespace psf::tests
