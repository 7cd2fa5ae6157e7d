// What denoisers get is what a naive loop over the paths finds, and the filter's own pictures.
#include <array>

#include "denoiser_oracle.h"
#include "export/denoiser_input.h"
#include "run/filter_dump.h"

using namespace psf;
using namespace psf::tests;
using exports::Denoiser;

namespace {

const std::array<std::string, 2> kFolders = {"camera_0/", "camera_1/"};

// Of a and b; that of the samples, over n - 1.
double covariance(const Values& a, const Values& b) {
  if (a.size() < 2) return 0;
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - mean_of(a)) * (b[k] - mean_of(b));
  return sum / static_cast<double>(a.size() - 1);
}

// Shares of a sample in BCD's bins: bin k is full where s = k / 18, the last where s = 2.
std::vector<double> shares_of(double value) {
  const double s = std::pow(std::max(value, 0.0), 1 / 2.2) / 2.5;
  std::vector<double> full, shares(20);
  for (int k = 0; k < 19; ++k) full.push_back(k / 18.0);
  full.push_back(2);
  if (s >= 2) shares[19] = 1;
  for (std::size_t k = 0; k + 1 < full.size(); ++k) {
    if (s < full[k] || s >= full[k + 1]) continue;
    shares[k + 1] = (s - full[k]) / (full[k + 1] - full[k]);
    shares[k] = 1 - shares[k + 1];
  }
  return shares;
}

std::string bin_name(std::size_t k) {
  const std::string number = std::to_string(k);
  return "Bin_" + std::string(4 - number.size(), '0') + number;
}

}  // namespace

TEST_CASE("NFOR gets means, half buffers and variances as a naive loop finds them") {
  for (const std::uint32_t shade_rate : {1u, 2u}) {
    CAPTURE(shade_rate);
    const TempFolder folder;
    DenoiserCase paths(shade_rate);
    const auto [left_out, overflows] = paths.spoil();
    paths.write(folder / "in.pvb");
    const auto result = write(Denoiser::nfor, folder / "in.pvb", folder / "out");
    CHECK(result.paths.left_out == left_out);
    CHECK(result.paths.overflows == overflows);
    CHECK(result.paths.passes == 6);
    CHECK(result.paths.paths == paths.set.size());
    CHECK(result.files.size() == 2 * 17);
    const Samples samples = paths.samples(0, paths.set.size());
    for (std::size_t camera = 0; camera < 2; ++camera) {
      const std::string in = (folder / "out") + "/" + kFolders[camera];
      for (const std::string what : {"color", "albedo", "normal", "depth"}) {
        const std::string channels = what == "depth" ? "Y" : "RGB";
        for (std::size_t c = 0; c < channels.size(); ++c) {
          CAPTURE(camera, what, c);
          const auto check = [&](const std::string& part, const auto& expected) {
            CAPTURE(part);
            const film::Image image = film::read_exr(in + what + part + ".exr");
            CHECK(image.layers.size() == channels.size());
            CHECK(wrong(image, std::string(1, channels[c]), samples[camera],
                        [&](const auto& pixel) { return expected(values_of(pixel, what, c)); }) ==
                  0);
          };
          check("", [](const Values& values) { return mean_of(values); });
          check("A", [](const Values& values) { return mean_of(values, 0, 2); });
          check("B", [](const Values& values) { return mean_of(values, 1, 2); });
          check("Variance", [](const Values& values) {
            return covariance(values, values) / static_cast<double>(values.size());
          });
        }
      }
    }
  }
}

TEST_CASE("BCD gets histograms and covariances as a naive loop finds them") {
  const TempFolder folder;
  DenoiserCase paths;
  paths.spoil();
  paths.write(folder / "in.pvb");
  CHECK(write(Denoiser::bcd, folder / "in.pvb", folder / "out").files.size() == 6);
  const Samples samples = paths.samples(0, paths.set.size());
  constexpr std::size_t kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  for (std::size_t camera = 0; camera < 2; ++camera) {
    CAPTURE(camera);
    const std::string in = (folder / "out") + "/" + kFolders[camera];
    const film::Image color = film::read_exr(in + "color.exr");
    const film::Image covariances = film::read_exr(in + "color_cov.exr");
    const film::Image histogram = film::read_exr(in + "color_hist.exr");
    CHECK(color.layers.size() == 3);
    CHECK(covariances.layers.size() == 6);
    CHECK(histogram.layers.size() == 61);
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(wrong(color, std::string(1, "RGB"[c]), samples[camera],
                  [&](const auto& pixel) { return mean_of(values_of(pixel, "color", c)); }) == 0);
      for (std::size_t k = 0; k < 20; ++k) {
        CAPTURE(c, k);
        CHECK(wrong(histogram, bin_name(20 * c + k), samples[camera], [&](const auto& pixel) {
                double sum = 0;
                for (const double value : values_of(pixel, "color", c)) sum += shares_of(value)[k];
                return sum;
              }) == 0);
      }
    }
    for (std::size_t k = 0; k < 6; ++k) {
      CAPTURE(k);
      CHECK(wrong(covariances, bin_name(k), samples[camera], [&](const auto& pixel) {
              return covariance(values_of(pixel, "color", kPairs[k][0]),
                                values_of(pixel, "color", kPairs[k][1]));
            }) == 0);
    }
    // All bins of a channel hold all samples.
    const std::vector<float>& count = *histogram.find("Bin_0060");
    for (std::size_t pixel = 0; pixel < count.size(); ++pixel) {
      CHECK(count[pixel] == static_cast<float>(samples[camera][pixel].size()));
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (std::size_t k = 0; k < 20; ++k)
          sum += double{(*histogram.find(bin_name(20 * c + k)))[pixel]};
        CHECK(sum == Approx(double{count[pixel]}));
      }
    }
  }
}

TEST_CASE("Black is in BCD's first bin, 2.5^2.2 in the last but one, 5^2.2 and more in the last") {
  CHECK(exports::bcd_bin_place(0) == 0);
  CHECK(exports::bcd_bin_place(-3) == 0);
  CHECK(exports::bcd_bin_place(std::pow(2.5, 2.2)) == Approx(18));
  CHECK(exports::bcd_bin_place(std::pow(2.5 * 3.25 / 18, 2.2)) == Approx(3.25));
  CHECK(exports::bcd_bin_place(std::pow(5, 2.2)) == Approx(19));
  CHECK(exports::bcd_bin_place(1e30) == 19);
}

TEST_CASE("Colours and features are those of the filter's pictures, to the last bit") {
  for (const std::uint32_t shade_rate : {1u, 2u}) {
    const TempFolder folder;
    DenoiserCase paths(shade_rate);
    paths.spoil();
    paths.options.passes = {293};
    paths.write(folder / "in.pvb");
    static_cast<void>(write(Denoiser::oidn, folder / "in.pvb", folder / "out"));
    const run::Dump dump(folder / "in.pvb");
    run::FilterRequest request;
    request.parameters.block.kind = filter::BlockSize::Kind::all;
    const run::FilterResult filtered = run::filter_dump(dump, request);
    for (std::size_t camera = 0; camera < 2; ++camera) {
      const film::Image image = filtered.pictures[camera].image();
      const std::string in = (folder / "out") + "/" + kFolders[camera];
      const auto same = [&](const std::string& file, const std::string& prefix,
                            const std::string& suffixes) {
        const std::vector<float> values = read_pfm(in + file, image.width, image.height);
        std::size_t differ = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const std::vector<float>& plane = *image.find(prefix + suffixes[c]);
          for (std::size_t pixel = 0; pixel < plane.size(); ++pixel) {
            differ += values[3 * pixel + c] == plane[pixel] ? 0u : 1u;
          }
        }
        CAPTURE(shade_rate, camera, file);
        CHECK(differ == 0);
      };
      same("color.pfm", "unfiltered-input.", "RGB");
      same("albedo.pfm", "albedo.", "RGB");
      same("normal.pfm", "normal.", "XYZ");
    }
  }
}

TEST_CASE("Half buffers add up to the mean, and equal samples have no variance") {
  const TempFolder folder;
  DenoiserCase paths(1, 1);
  for (Rgb& rho : paths.set.reflectance) rho = Rgb(0.1f, 0.7f, 0.3f);
  for (std::uint8_t& flags : paths.set.flags) flags = filter::kHasVertex | filter::kShaded;
  paths.write(folder / "in.pvb");
  static_cast<void>(write(Denoiser::nfor, folder / "in.pvb", folder / "out"));
  const auto read = [&](const std::string& name) {
    return film::read_exr((folder / "out") + "/" + name + ".exr");
  };
  const film::Image whole = read("color"), a = read("colorA"), b = read("colorB");
  const Samples samples = paths.samples(0, paths.set.size());
  for (std::size_t pixel = 0; pixel < 20; ++pixel) {
    const double n = static_cast<double>(samples[0][pixel].size());
    REQUIRE(n > 1);
    const double sum = std::ceil(n / 2) * double{(*a.find("G"))[pixel]} +
                       std::floor(n / 2) * double{(*b.find("G"))[pixel]};
    CHECK(sum / n == Approx(double{(*whole.find("G"))[pixel]}).epsilon(1e-6));
    CHECK((*a.find("G"))[pixel] != (*b.find("G"))[pixel]);
  }
  const film::Image variance = read("albedoVariance");
  for (const film::Layer& layer : variance.layers) {
    CHECK(std::count(layer.values.begin(), layer.values.end(), 0.0f) == 20);
  }
}
