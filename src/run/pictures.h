// The pictures of one camera that a filter run makes: the result, the input, and layers that help
// to understand the result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "film/film.h"
#include "film/image.h"
#include "filter/estimate.h"
#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "run/pixel_features.h"

namespace psf::run {

// The layers of a picture in addition to R, G, B.
struct PictureLayers {
  bool unfiltered = true, neighbors = true, radius = true;
  bool albedo = true, normal = true;  // where the dump has the channels
  bool alpha = true;                  // the same: A, and the background apart
  bool fireflies = true;              // where they are spread
  // The layers of the light, by name; not set: all that the dump has.
  std::optional<std::vector<std::string>> light = {};

  [[nodiscard]] static PictureLayers none() {
    return {false, false, false, false, false, false, false, std::vector<std::string>()};
  }
};

class CameraPictures {
 public:
  // `layers.light`: the names of the layers that the records will have, in their order.
  CameraPictures(const filter::CameraView& camera, const PictureLayers& layers,
                 filter::PixelRule rule);

  // Adds record i of a filtered block [pixel], without its layers of the light. Add the records of
  // a pixel in path order, from one thread, which are all finite.
  void add(const filter::Records& records, const filter::Estimates& estimates,
           std::span<const float> radius, std::size_t i);
  // Adds what layer k of the records has of `some` records to the pictures of their cameras, but for
  // those of which it overflows.
  static void add_layer(std::size_t k, const filter::Records& records,
                        const filter::Estimates& estimates, std::span<const std::size_t> some,
                        std::span<CameraPictures> pictures);

  // The picture with R, G, B, filtered, and those of these layers that were asked for:
  // unfiltered-input.R/G/B, over the paths for which is_input() is true, filled as in
  // film::Film::filled_mean() where a pixel has no such path; neighbors.Y and radius.Y, means over
  // the paths with a vertex; albedo.R/G/B and normal.X/Y/Z, where paths without vertex count as 0.
  // With PictureLayers::alpha: A, the mean coverage; the light of paths whose coverage is 0 is then
  // in none of the colours but in background.R/G/B and unfiltered-input.background.R/G/B
  // (film::kBackgroundIs).
  // fireflies.R/G/B: alpha times what [fireflies] have spread, a part of the filtered picture.
  // Of each layer of the light what there is of the whole: NAME.R/G/B, and unfiltered-input.NAME;
  // the attribute film::kLightLayers has their names.
  // With PixelRule::regress the filtered picture, A, fireflies and all parts of the light have gone
  // through filter::second_pass().
  [[nodiscard]] film::Image image() const;

  [[nodiscard]] bool has_alpha() const { return layers_.alpha; }
  [[nodiscard]] const std::vector<std::string>& light_layers() const { return layer_names_; }
  // How far the layers of the light are from adding up to the filtered picture: the differences, as
  // a share of its light; 0 where there are none.
  [[nodiscard]] double light_beside_layers() const;

  // The bytes per pixel of the sums, and those that image() and writing it take temporarily; of
  // alpha and of each layer of the light beside.
  static constexpr std::uint64_t kBytesOfFilm = 3 * sizeof(double) + sizeof(std::uint64_t);
  static constexpr std::uint64_t kBytesOfSums = 5 * kBytesOfFilm;
  static constexpr std::uint64_t kBytesToWrite = sizeof(float) * 2 * 14;
  static constexpr std::uint64_t kBytesOfSumsOfAlpha = kBytesOfFilm + sizeof(double) * 2 * 3;
  static constexpr std::uint64_t kBytesToWriteOfAlpha = sizeof(float) * 2 * 7;
  static constexpr std::uint64_t kBytesOfSumsOfRegress =
      PixelFeatures::kBytesAPixel + 6 * sizeof(double);
  static constexpr std::uint64_t kBytesOfFireflies = kBytesOfFilm + sizeof(float) * 2 * 3;
  static constexpr std::uint64_t kBytesOfSumsALayer = sizeof(double) * 2 * 3;
  static constexpr std::uint64_t kBytesToWriteALayer = sizeof(float) * 2 * 6;

 private:
  [[nodiscard]] std::vector<float> filled(std::size_t part) const;
  // Whether record i is of a background that is kept apart.
  [[nodiscard]] bool is_background(const filter::Records& records, std::size_t i) const {
    return layers_.alpha && records.coverage[i] == 0;
  }
  void add_guides(const filter::Records& records, std::size_t i, bool vertex);
  void add_fireflies(const filter::Records& records, const filter::Estimates& estimates,
                     std::size_t i, bool vertex);
  void add_to_features(const filter::Records& records, filter::Role role, const Rgb& radiance,
                       std::size_t i);
  [[nodiscard]] filter::PixelStatistics statistics() const;

  std::vector<std::string> layer_names_;  // of the light
  // Parts: the whole, then the layers, then the background where it is kept apart.
  film::Film filtered_, unfiltered_;
  film::Film details_;  // neighbours, radius, 0
  PictureLayers layers_;
  film::Film albedo_, normal_;
  film::Film alpha_;  // coverage, 0, 0
  film::Film fireflies_;
  PixelFeatures features_;       // empty: there is no second pass
  std::vector<double> moments_;  // (pixels, 6): sums of the filtered radiance and of its squares
};

// Adds the records [first, last) of a filtered block to the pictures of their cameras. Threads
// share the pixels, so the sums are the same for any number of threads. Returns how many paths were
// left out because of an overflow.
[[nodiscard]] std::uint64_t add_records(const filter::Records& records,
                                        const filter::Estimates& estimates,
                                        std::span<const float> radius, std::size_t first,
                                        std::size_t last, std::span<CameraPictures> pictures);

}  // namespace psf::run
