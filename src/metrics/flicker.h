// The error of a sequence of pictures against references, and how much it changes from frame to
// frame.
//
//     e_f     = (x_f - r_f) / sqrt(r_f^2 + epsilon)                    by pixel and colour channel
//     error   = mean of e_f^2 over frames, pixels and channels: the mean relMSE
//     flicker = mean over pixels and channels of  Var_f( e_(f+1) - e_f )                 [flicker]
//
// of what is left where the share `trim` of the pixels is left out, for each of the two those where
// it is largest. Var is a sample's, over one less than the number of changes. An error that stays
// where it is, as bias does in a still picture, does not flicker; errors of variance V that have
// nothing to do with those of the frame before have a flicker of 2 V.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/vec.h"

namespace psf::metrics {

class Flicker {
 public:
  // `pixels`: of every picture. Throws Error{usage} where epsilon is not above 0.
  explicit Flicker(std::size_t pixels, double epsilon = 1e-2);

  // The next frame: linear colours, as many as there are pixels. A pixel that is not finite in one
  // of them is left out of all frames.
  void add(std::span<const Rgb> picture, std::span<const Rgb> reference);

  [[nodiscard]] std::size_t frames() const { return frames_; }
  [[nodiscard]] std::size_t left_out() const;  // pixels
  // `trim`: in [0, 1). NaN where no pixel was left.
  [[nodiscard]] double error(double trim = 0) const;
  // NaN with fewer than 3 frames, which have fewer than 2 changes.
  [[nodiscard]] double flicker(double trim = 0) const;
  // Of every pixel, flicker's mean over the channels; 0 where a pixel was left out.
  [[nodiscard]] std::vector<double> map() const;

 private:
  struct Value {
    double last = 0, squares = 0;      // e_f, and the sum of its squares
    double mean = 0, differences = 0;  // of the changes: mean, sum of squared differences from it
  };
  [[nodiscard]] double mean_of_smallest(std::vector<double> of_pixels, double trim) const;

  double epsilon_;
  std::size_t frames_ = 0;
  std::vector<Value> values_;  // (pixels, 3)
  std::vector<char> is_out_;   // by pixel
};

}  // namespace psf::metrics
