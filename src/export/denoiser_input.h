// What is summed up and written for one denoiser and one camera.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "export/output_folder.h"
#include "film/attributes.h"
#include "film/image.h"
#include "run/unfiltered_paths.h"

namespace psf::exports {

// The size of the picture, and which channels the dump has.
struct DenoiserSource {
  std::size_t width = 0, height = 0;
  bool albedo = false, normal = false, depth = false;

  [[nodiscard]] std::size_t pixels() const { return width * height; }
};

// Writes the pictures of a camera into an OutputFolder.
class PictureFolder {
 public:
  // `inside`: the camera's folder with its slash, or "". Keeps references to the folder, the list
  // and the sum.
  PictureFolder(OutputFolder& folder, std::string inside, film::Attributes attributes,
                std::vector<std::string>& files, std::uint64_t& bytes)
      : folder_(folder),
        inside_(std::move(inside)),
        attributes_(std::move(attributes)),
        files_(files),
        bytes_(bytes) {}

  // The names are those of files, with their endings. Each throws Error{io}.
  void write_exr(const std::string& name, film::Image image);
  // A portable float map, little-endian, of (height, width, 3) values, row 0 at the top.
  void write_pfm(const std::string& name, std::size_t width, std::size_t height,
                 std::span<const float> rgb);
  void write_text(const std::string& name, const std::string& text);

 private:
  OutputFolder& folder_;
  std::string inside_;
  film::Attributes attributes_;
  std::vector<std::string>& files_;
  std::uint64_t& bytes_;
};

class DenoiserInput {
 public:
  virtual ~DenoiserInput() = default;
  // Adds a path of this camera; those of a pixel in path order and from one thread.
  virtual void add(const run::UnfilteredPath& path) = 0;
  virtual void write(PictureFolder& folder) = 0;
};

// color.pfm, albedo.pfm and normal.pfm, as `oidnDenoise --hdr color.pfm --alb albedo.pfm --nrm
// normal.pfm` takes them (github.com/RenderKit/oidn, apps/oidnDenoise.cpp and doc/api.md): linear
// colours, albedos in [0, 1], normals as they are, in [-1, 1], of any length. A pixel without path
// has the colour of those around it (film::Film::filled_mean()).
[[nodiscard]] std::unique_ptr<DenoiserInput> make_oidn_input(const DenoiserSource& source);

// What the program `denoiser` of Tungsten reads, the public implementation of NFOR by an author of
// the paper (github.com/tunabrain/tungsten, src/denoiser/README.md and denoiser.cpp; what the
// renderer writes for it: src/core/cameras/OutputBuffer.hpp). Bitterli et al. 2016, "Nonlinearly
// Weighted First-order Regression for Denoising Monte Carlo Renderings". For color, albedo, normal
// (all R, G, B) and depth (Y): NAME.exr, the mean; NAMEA.exr and NAMEB.exr, the means of the samples
// 0, 2, 4, ... and 1, 3, 5, ... of each pixel; NAMEVariance.exr, the sample variance of the mean. And
// scene.json, which lists them. The variance of a pixel of one sample is 0.
[[nodiscard]] std::unique_ptr<DenoiserInput> make_nfor_input(const DenoiserSource& source);

// What bcd_cli reads (github.com/superboubek/bcd, README.md; how samples are counted:
// src/core/SamplesAccumulator.cpp). Boughida and Boubekeur 2017, "Bayesian Collaborative Denoising
// for Monte Carlo Rendering". color.exr, R, G, B; color_hist.exr, Bin_0000 to Bin_0059, 20 bins each
// of red, green and blue, and Bin_0060, the number of samples; color_cov.exr, Bin_0000 to Bin_0005,
// the sample covariances xx, yy, zz, yz, xz, xy of the colours of a pixel's samples, 0 where it has
// one.
[[nodiscard]] std::unique_ptr<DenoiserInput> make_bcd_input(const DenoiserSource& source);

// The bins of a channel in BCD's histograms.
inline constexpr std::size_t kBcdBins = 20;
// Where a value lies on the axis of the bins, in [0, kBcdBins - 1]: it is shared by the two bins on
// both sides, linearly. With s = max(value, 0)^(1 / 2.2) / 2.5, values up to s = 1 have all bins
// but the last, and the last is reached at s = 2.
[[nodiscard]] double bcd_bin_place(double value);

}  // namespace psf::exports
