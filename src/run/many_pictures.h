// The pictures of one camera for many radii, kept as sums over paths [pixel].
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "film/film.h"
#include "filter/estimate.h"
#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "run/pixel_features.h"

namespace psf::run {

class ManyPictures {
 public:
  ManyPictures(const filter::CameraView& camera, std::size_t radii, filter::PixelRule rule);

  [[nodiscard]] std::size_t width() const { return input_.width(); }
  [[nodiscard]] std::size_t height() const { return input_.height(); }

  // The filtered picture for radius k, (height, width); the same as from CameraPictures, except for
  // rounding. With PixelRule::regress it goes through filter::second_pass() here.
  [[nodiscard]] std::vector<Rgb> filtered(std::size_t k) const;
  // The picture without filter of the same paths, (height, width), as from CameraPictures.
  [[nodiscard]] std::vector<Rgb> unfiltered() const;
  // The mean of u_i, (height, width): the part of filtered() that is the same for every radius.
  [[nodiscard]] std::vector<Rgb> u() const;

  // The number of radii in a group, which are added together.
  static constexpr std::size_t kTogether = 8;

  // The bytes per pixel that the sums for `radii` radii take.
  [[nodiscard]] static constexpr std::uint64_t bytes_of_sums(std::size_t radii,
                                                             filter::PixelRule rule) {
    const std::uint64_t groups = (radii + kTogether - 1) / kTogether;
    const std::uint64_t sums =
        3 * sizeof(double) * (groups * kTogether + 2) + 2 * sizeof(std::uint64_t);
    if (rule == filter::PixelRule::keep) return sums;
    return sums + 3 * sizeof(double) * (groups * kTogether + 1) + PixelFeatures::kBytesAPixel;
  }

  // Whether record i is a source whose u + alpha c is not finite; such a path is in no picture.
  [[nodiscard]] static bool overflows(const filter::Records& records, filter::Role role,
                                      std::size_t i);
  // Adds record i of a block to all pictures, without alpha c_bar, which add_filtered() adds. Does
  // nothing for records that are left out or overflow.
  void add_record(const filter::Records& records, filter::Role role, std::size_t i);
  // Adds alpha c_bar of record i for the radii [first, first + c_bar.size()). The record itself
  // must not overflow. A radius for which u + alpha c_bar overflows is not added, and `overflows`
  // is called with it.
  void add_filtered(const filter::Records& records, std::size_t i, std::size_t first,
                    std::span<const Rgb> c_bar,
                    const std::function<void(std::size_t radius)>& overflows);
  // Takes back what add_record() added for record i, in the picture of radius k alone.
  void leave_out(const filter::Records& records, std::size_t i, std::size_t k);

 private:
  // Adds alpha c_bar for radii of one group, from place `first` in it on. Returns the radii that
  // overflow: bit k stands for c_bar[k].
  // With a second pass also adds the squares of u + alpha c_bar to `squares`.
  static std::uint32_t add_group(const Rgb& u, const Rgb& alpha, double* sum, double* squares,
                                 std::size_t first, std::span<const Rgb> c_bar);
  struct Missing {
    std::uint64_t paths = 0;
    double u[3] = {};
  };

  [[nodiscard]] std::size_t place_of(std::size_t pixel, std::size_t k) const {
    return ((pixel * groups_ + k / kTogether) * kTogether + k % kTogether) * 3;
  }
  // The paths of a pixel in the picture of radius k, and the sum of their u.
  struct Paths {
    double count;
    double u[3];
  };
  [[nodiscard]] Paths paths_of(std::uint32_t pixel, std::size_t k) const;
  void regress(std::size_t k, std::vector<Rgb>& picture) const;

  std::size_t groups_;                // number of groups of kTogether radii
  std::vector<double> filtered_;      // (pixels, groups, kTogether, 3) sums of alpha c_bar
  std::vector<double> u_;             // (pixels, 3) sums of u
  std::vector<std::uint64_t> paths_;  // (pixels) number of paths
  film::Film input_;
  // With a second pass, of the filtered radiance: squares like filtered_, and those of paths without
  // vertex, which are the same for every radius, like u_.
  std::vector<double> squares_, u_squares_;
  PixelFeatures features_;
  std::map<std::pair<std::uint32_t, std::size_t>, Missing> missing_;  // by pixel and radius
};

}  // namespace psf::run
