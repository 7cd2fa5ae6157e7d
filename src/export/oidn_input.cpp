// Means for Open Image Denoise.
#include <optional>

#include "export/denoiser_input.h"
#include "film/film.h"

namespace psf::exports {
namespace {

class OidnInput : public DenoiserInput {
 public:
  explicit OidnInput(const DenoiserSource& source) : color_(source.width, source.height) {
    if (source.albedo) albedo_.emplace(source.width, source.height);
    if (source.normal) normal_.emplace(source.width, source.height);
  }
  void add(const run::UnfilteredPath& path) override {
    if (path.in_picture) color_.add(path.pixel, path.radiance);
    if (albedo_) albedo_->add(path.pixel, path.reflectance);
    if (normal_) normal_->add(path.pixel, Rgb(path.normal.x, path.normal.y, path.normal.z));
  }
  void write(PictureFolder& folder) override {
    const auto write_mean = [&](const char* name, const std::vector<float>& mean) {
      folder.write_pfm(name, color_.width(), color_.height(), mean);
    };
    write_mean("color.pfm", color_.filled_mean());
    if (albedo_) write_mean("albedo.pfm", albedo_->mean());
    if (normal_) write_mean("normal.pfm", normal_->mean());
  }

 private:
  film::Film color_;
  std::optional<film::Film> albedo_, normal_;
};

}  // namespace

std::unique_ptr<DenoiserInput> make_oidn_input(const DenoiserSource& source) {
  return std::make_unique<OidnInput>(source);
}

}  // namespace psf::exports
