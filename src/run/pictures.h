// The pictures of one camera that a filter run makes: the result, the input, and layers that help
// to understand the result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "film/film.h"
#include "film/image.h"
#include "filter/estimate.h"
#include "filter/records.h"

namespace psf::run {

// The layers of a picture in addition to R, G, B.
struct PictureLayers {
  bool unfiltered = true, neighbors = true, radius = true;
  bool albedo = true, normal = true;  // where the dump has the channels
};

class CameraPictures {
 public:
  CameraPictures(const filter::CameraView& camera, const PictureLayers& layers);

  // Adds record i of a filtered block [pixel]. Add the records of a pixel in path order, from one
  // thread. Returns false where the radiance overflows; then the path is left out.
  bool add(const filter::Records& records, const filter::Estimates& estimates,
           std::span<const float> radius, std::size_t i);

  // The picture with R, G, B, filtered, and those of these layers that were asked for:
  // unfiltered-input.R/G/B, over the paths for which is_input() is true, filled as in
  // film::Film::filled_mean() where a pixel has no such path; neighbors.Y and radius.Y, means over
  // the paths with a vertex; albedo.R/G/B and normal.X/Y/Z, where paths without vertex count as 0.
  [[nodiscard]] film::Image image() const;

  // The bytes per pixel of the sums, and those that image() and writing it take temporarily.
  static constexpr std::uint64_t kBytesOfSums = 5 * (3 * sizeof(double) + sizeof(std::uint64_t));
  static constexpr std::uint64_t kBytesToWrite = sizeof(float) * 2 * 14;

 private:
  [[nodiscard]] std::vector<float> unfiltered() const;
  void add_guides(const filter::Records& records, std::size_t i, bool vertex);

  film::Film filtered_, unfiltered_;
  film::Film details_;  // neighbours, radius, 0
  PictureLayers layers_;
  film::Film albedo_, normal_;
};

// Adds the records [first, last) of a filtered block to the pictures of their cameras. Threads
// share the pixels, so the sums are the same for any number of threads. Returns how many paths were
// left out because of an overflow.
[[nodiscard]] std::uint64_t add_records(const filter::Records& records,
                                        const filter::Estimates& estimates,
                                        std::span<const float> radius, std::size_t first,
                                        std::size_t last, std::span<CameraPictures> pictures);

}  // namespace psf::run
