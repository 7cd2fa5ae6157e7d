// The records of one block with their memory, reused from block to block.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/channels.h"
#include "filter/records.h"
#include "run/photons.h"

namespace psf::run {

// Columns that were not asked for are empty. Vec3 and Rgb are three packed floats.
struct BlockRecords {
  std::vector<std::uint8_t> flags;
  std::vector<Vec3> position;
  std::vector<float> distance;
  std::vector<Rgb> throughput, contribution, unfiltered;
  std::vector<std::uint32_t> pixel;
  std::vector<std::uint16_t> camera;
  std::vector<Vec3> normal;
  std::vector<Rgb> reflectance;
  std::vector<std::uint32_t> visibility;
  std::vector<float> hit_distance;
  std::vector<Vec3> direction;
  std::vector<std::uint32_t> material;
  std::vector<float> roughness;
  std::vector<float> coverage;
  std::vector<std::uint8_t> kind;
  std::vector<Vec3> rest_position;
  std::uint64_t not_finite_coverage = 0;  // values that are 1 in place of what the file has
  // The columns of the layers, and the views of them that view() gives out.
  struct LayerColumns {
    struct Column {
      std::vector<Rgb> values;       // empty: all are 0
      std::uint64_t not_finite = 0;  // values that are 0 in place of what the file has
    };
    Column contribution, unfiltered;
  };
  std::vector<LayerColumns> layers;
  std::vector<filter::Layer> layer_views;
  PhotonColumns photons;

  [[nodiscard]] filter::Records view() const {
    filter::Records records;
    filter::for_each_channel(
        [&](const char*, const auto& member) { member(records) = member(*this); });
    records.layers = layer_views;
    records.photons = photons.view();
    return records;
  }
};

}  // namespace psf::run
