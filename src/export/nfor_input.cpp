// Means, half buffers and variances for NFOR.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/json_text.h"
#include "export/denoiser_input.h"

namespace psf::exports {
namespace {

// Moments of the samples of each pixel: of colours, or of a feature. The mean that the variance is
// about moves along with the samples (Welford 1962), so that equal samples have the variance 0.
class SampleMoments {
 public:
  // `suffixes`: the channels, one a component.
  SampleMoments(std::string name, std::string suffixes, const DenoiserSource& source)
      : name_(std::move(name)),
        suffixes_(std::move(suffixes)),
        width_(source.width),
        height_(source.height),
        counts_(source.pixels()),
        sums_(source.pixels() * suffixes_.size()) {}

  void add(std::size_t pixel, const std::array<float, 3>& values) {
    const std::uint32_t before = counts_[pixel]++;
    for (std::size_t c = 0; c < suffixes_.size(); ++c) {
      Sums& sums = sums_[pixel * suffixes_.size() + c];
      const double value = double{values[c]};
      const double old_mean = before > 0 ? sums.all() / before : 0;
      sums.half[before % 2] += value;
      if (before > 0) sums.squares += (value - old_mean) * (value - sums.all() / (before + 1.0));
    }
  }

  [[nodiscard]] const std::string& name() const { return name_; }

  void write(PictureFolder& folder) const {
    write_plane(folder, "", [](const Sums& sums, double n) { return sums.all() / n; });
    write_plane(folder, "A",
                [](const Sums& sums, double n) { return sums.half[0] / std::ceil(n / 2); });
    write_plane(folder, "B", [](const Sums& sums, double n) {
      return n > 1 ? sums.half[1] / std::floor(n / 2) : 0;
    });
    write_plane(folder, "Variance", [](const Sums& sums, double n) {
      return n > 1 ? std::max(0.0, sums.squares) / (n * (n - 1)) : 0;
    });
  }

 private:
  struct Sums {
    std::array<double, 2> half = {};  // of the samples 0, 2, 4, ..., and of 1, 3, 5, ...
    double squares = 0;               // of the differences from the mean

    [[nodiscard]] double all() const { return half[0] + half[1]; }
  };

  // value(sums, n) where a pixel has n > 0 samples, else 0.
  template <class Value>
  void write_plane(PictureFolder& folder, const std::string& part, const Value& value) const {
    film::Image image;
    image.width = width_;
    image.height = height_;
    for (std::size_t c = 0; c < suffixes_.size(); ++c) {
      std::vector<float> plane(counts_.size());
      for (std::size_t pixel = 0; pixel < plane.size(); ++pixel) {
        if (counts_[pixel] == 0) continue;
        plane[pixel] = static_cast<float>(
            value(sums_[pixel * suffixes_.size() + c], static_cast<double>(counts_[pixel])));
      }
      image.layers.push_back({std::string(1, suffixes_[c]), std::move(plane)});
    }
    folder.write_exr(name_ + part + ".exr", std::move(image));
  }

  std::string name_, suffixes_;
  std::size_t width_, height_;
  std::vector<std::uint32_t> counts_;
  std::vector<Sums> sums_;  // (pixels, components)
};

class NforInput : public DenoiserInput {
 public:
  explicit NforInput(const DenoiserSource& source) : color_("color", "RGB", source) {
    if (source.albedo) albedo_.emplace("albedo", "RGB", source);
    if (source.normal) normal_.emplace("normal", "RGB", source);
    if (source.depth) depth_.emplace("depth", "Y", source);
  }
  void add(const run::UnfilteredPath& path) override {
    const auto values = [](const auto& v) { return std::array{v.x, v.y, v.z}; };
    if (path.in_picture) color_.add(path.pixel, values(path.radiance));
    if (albedo_) albedo_->add(path.pixel, values(path.reflectance));
    if (normal_) normal_->add(path.pixel, values(path.normal));
    if (depth_) depth_->add(path.pixel, {path.distance});
  }
  void write(PictureFolder& folder) override {
    auto buffers = nlohmann::ordered_json::array();
    for (const SampleMoments* moments :
         {&color_, depth_ ? &*depth_ : nullptr, albedo_ ? &*albedo_ : nullptr,
          normal_ ? &*normal_ : nullptr}) {
      if (moments == nullptr) continue;
      moments->write(folder);
      buffers.push_back({{"type", moments->name()},
                         {"hdr_output_file", moments->name() + ".exr"},
                         {"sample_variance", true},
                         {"two_buffer_variance", true}});
    }
    const nlohmann::ordered_json scene = {{"renderer", {{"output_buffers", buffers}}}};
    folder.write_text("scene.json", core::json_file_text(scene));
  }

 private:
  SampleMoments color_;
  std::optional<SampleMoments> albedo_, normal_, depth_;
};

}  // namespace

std::unique_ptr<DenoiserInput> make_nfor_input(const DenoiserSource& source) {
  return std::make_unique<NforInput>(source);
}

}  // namespace psf::exports
