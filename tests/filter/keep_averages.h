// Keeps c_bar of every record for every radius, as estimate_many() hands it out.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filter/many_radii.h"

namespace psf::tests {

class KeepAverages : public filter::Receiver {
 public:
  KeepAverages(std::size_t records, std::size_t radii)
      : c_bar(radii, std::vector<Rgb>(records, Rgb(0, 0, 0))) {}
  void begin(std::span<const std::uint32_t> queries, std::size_t grain) override {
    queries_ = queries;
    grain_ = grain;
  }
  void take(std::size_t part, std::size_t first, std::size_t count,
            std::span<const Rgb> values) override {
    for (std::size_t q = 0; q * count < values.size(); ++q) {
      const std::uint32_t i = queries_[part * grain_ + q];
      for (std::size_t k = 0; k < count; ++k) c_bar[first + k][i] = values[q * count + k];
    }
    taken_ += values.size();
  }
  void end() override { seen = taken_; }

  std::vector<std::vector<Rgb>> c_bar;  // by radius, then by record
  std::size_t seen = 0;                 // values, once it has ended

 private:
  std::span<const std::uint32_t> queries_;
  std::size_t grain_ = 0;
  std::atomic<std::size_t> taken_ = 0;
};

}  // namespace psf::tests
