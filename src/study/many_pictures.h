// The pictures of one camera for many radii, as sums [pixel].
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "film/film.h"
#include "filter/average.h"
#include "filter/records.h"

namespace psf::study {

class ManyPictures {
 public:
  ManyPictures(const filter::CameraView& camera, std::size_t radii);

  [[nodiscard]] std::size_t width() const { return input_.width(); }
  [[nodiscard]] std::size_t height() const { return input_.height(); }

  // (height, width) of radius k: the picture that CameraPictures gives, but for rounding.
  [[nodiscard]] std::vector<Rgb> filtered(std::size_t k) const;
  // (height, width) of the same paths without filter, as CameraPictures has it.
  [[nodiscard]] std::vector<Rgb> unfiltered() const;
  // (height, width) of u alone: what no radius changes in filtered().
  [[nodiscard]] std::vector<Rgb> u() const;

  // Radii that are added together.
  static constexpr std::size_t kTogether = 8;

  // Bytes a pixel for so many radii.
  [[nodiscard]] static constexpr std::uint64_t bytes_of_sums(std::size_t radii) {
    return 3 * sizeof(double) * ((radii + kTogether - 1) / kTogether * kTogether + 2) +
           2 * sizeof(std::uint64_t);
  }

  // Whether u + alpha c of a source overflows: then the path is in no picture.
  [[nodiscard]] static bool overflows(const filter::Records& records, filter::Role role,
                                      std::size_t i);
  // Adds record i of a block, but for c_bar, which add_filtered() does; nothing where it overflows.
  void add_record(const filter::Records& records, filter::Role role, std::size_t i);
  // alpha c_bar of radii [first, first + c_bar.size()) for record i, which does not overflow
  // itself. Visits each radius for which u + alpha c_bar overflows: it is left out.
  void add_filtered(const filter::Records& records, std::size_t i, std::size_t first,
                    std::span<const Rgb> c_bar,
                    const std::function<void(std::size_t radius)>& overflows);
  // Takes back what add_record() added of record i, for radius k alone.
  void leave_out(const filter::Records& records, std::size_t i, std::size_t k);

 private:
  // The same for one group of kTogether; a bit for each that overflows.
  std::uint32_t add_group(const Rgb& alpha, double* sum, std::size_t first,
                          std::span<const Rgb> c_bar);
  struct Missing {
    std::uint64_t paths = 0;
    double u[3] = {};
  };

  [[nodiscard]] const double* filtered_sum(std::size_t pixel, std::size_t k) const {
    const std::size_t group = k / kTogether;
    return &filtered_[((pixel * groups_ + group) * kTogether + k % kTogether) * 3];
  }

  std::size_t groups_;                // of kTogether radii
  std::vector<double> filtered_;      // (pixels, groups, kTogether, 3) of alpha c_bar
  std::vector<double> u_;             // (pixels, 3)
  std::vector<std::uint64_t> paths_;  // of a pixel
  film::Film input_;
  std::map<std::pair<std::uint32_t, std::size_t>, Missing> missing_;  // by pixel and radius
};

}  // namespace psf::study
