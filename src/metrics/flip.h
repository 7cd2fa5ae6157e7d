// LDR-FLIP: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild, "FLIP: A Difference
// Evaluator for Alternating Images" (2020), with its constants, on the displayed picture.
#pragma once

#include <span>

#include "metrics/displayed.h"

namespace psf::metrics {

class Flip {
 public:
  Flip(const Displayed& reference, double pixels_per_degree);
  // Writes FLIP of every pixel, in [0, 1], to `errors`, (height, width).
  void measure(const Displayed& picture, std::span<double> errors) const;

 private:
  struct Kernels {
    Kernel achromatic, red_green;         // contrast sensitivity, along one axis
    Kernel blue_yellow_1, blue_yellow_2;  // the two Gaussians that add up to the third
    Kernel smooth, edge, point;           // feature detection
  };
  struct Features {
    Displayed color;    // L*, a*, b* as the eye sees them from this distance, Hunt-adjusted
    Plane edge, point;  // strength of edges and of points
  };
  [[nodiscard]] static Kernels kernels(double pixels_per_degree);
  [[nodiscard]] Features features(const Displayed& picture) const;

  Kernels kernels_;
  Features reference_;
};

}  // namespace psf::metrics
