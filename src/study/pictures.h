// What a filter run shows of one camera: the picture, what went in, and what helps to understand
// it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "film/film.h"
#include "film/image.h"
#include "filter/average.h"
#include "filter/records.h"

namespace psf::study {

// What a picture shows beside R, G, B.
struct PictureLayers {
  bool unfiltered = true, neighbors = true, radius = true;
  bool albedo = true, normal = true;  // where the dump has the channels
};

class CameraPictures {
 public:
  CameraPictures(const filter::CameraView& camera, const PictureLayers& layers);

  // [pixel]: adds record i of a filtered block. A pixel's records in path order, from one thread.
  // Returns false where the radiance overflows; then the path is left out.
  bool add(const filter::Records& records, const filter::Average& average,
           std::span<const float> radius, std::size_t i);

  // R, G, B filtered; unfiltered-input.R/G/B of those of the same paths that is_input() names, a
  // pixel that has none of these filled as film::Film::filled_mean() has it; neighbors.Y and
  // radius.Y, means over the paths with a vertex; albedo.R/G/B and normal.X/Y/Z, 0 where a path has
  // no vertex. Of them those that were asked for.
  [[nodiscard]] film::Image image() const;

  // Bytes a pixel: of the sums, and what image() and writing it take for a moment.
  static constexpr std::uint64_t kBytesOfSums = 5 * (3 * sizeof(double) + sizeof(std::uint64_t));
  static constexpr std::uint64_t kBytesToWrite = 2 * 14 * sizeof(float);

 private:
  [[nodiscard]] std::vector<float> unfiltered() const;
  void add_guides(const filter::Records& records, std::size_t i, bool vertex);

  film::Film filtered_, unfiltered_;
  film::Film details_;  // neighbours, radius, 0
  PictureLayers layers_;
  film::Film albedo_, normal_;
};

// Adds records [first, last) of a filtered block to the pictures of their cameras, threads sharing
// the pixels: the same sums for any number of threads. Returns how many paths were left out because
// of an overflow.
[[nodiscard]] std::uint64_t add_records(const filter::Records& records,
                                        const filter::Average& average,
                                        std::span<const float> radius, std::size_t first,
                                        std::size_t last, std::span<CameraPictures> pictures);

}  // namespace psf::study
