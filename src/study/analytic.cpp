#include "study/analytic.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "filter/radius.h"
#include "formats/layout/metadata.h"
#include "formats/write/writer.h"
#include "study/theory.h"

namespace psf::study {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWaveNumber = 4 * kPi, kAmplitude = 0.5;
constexpr double kLeft = 1, kRight = 3, kEdge = 0.5;
constexpr int kSteps = 32;  // number of steps of the midpoint rule, for the mean over a pixel

template <class Function>
double mean_over_pixel(std::size_t column, const Function& function) {
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    sum += function((static_cast<double>(column) + (k + 0.5) / kSteps) / Analytic::kSize);
  }
  return sum / kSteps;
}

}  // namespace

const char* Analytic::name() const {
  return scene_ == AnalyticScene::smooth ? "smooth" : "edge";
}

double Analytic::f(double x) const {
  if (scene_ == AnalyticScene::smooth) return 1 + kAmplitude * std::cos(kWaveNumber * x);
  return x < kEdge ? kLeft : kRight;
}

double Analytic::f_over_disk(double x, double r) const {
  if (r <= 0) return f(x);
  if (scene_ == AnalyticScene::edge) {
    return kLeft + (kRight - kLeft) * share_right((x - kEdge) / r);
  }
  // The mean of a plane wave over a disk: 2 J1(k r) / (k r) times the wave at the centre.
  const double kr = kWaveNumber * r;
  return 1 + kAmplitude * std::cos(kWaveNumber * x) * 2 * std::cyl_bessel_j(1.0, kr) / kr;
}

std::vector<Rgb> Analytic::reference() const {
  std::vector<Rgb> picture(kSize * kSize);
  for (std::size_t column = 0; column < kSize; ++column) {
    const auto value =
        static_cast<float>(mean_over_pixel(column, [this](double x) { return f(x); }));
    for (std::size_t row = 0; row < kSize; ++row) {
      picture[row * kSize + column] = Rgb(value, value, value);
    }
  }
  return picture;
}

void Analytic::write_dump(const std::string& path, std::uint64_t seed, std::uint64_t passes) const {
  formats::Metadata metadata;
  metadata.producer = "psf converge --analytic";
  metadata.scene = std::string("analytic ") + name();
  metadata.scene_hash = metadata.scene;
  metadata.integrator = "analytic";
  metadata.sampler = "independent";
  metadata.enumeration = "pixel";
  metadata.seed = seed;
  formats::CameraInfo camera;
  camera.name = "above";
  camera.width = camera.height = kSize;
  camera.angle_per_pixel = 1.0 / kSize;
  metadata.cameras.push_back(camera);
  using formats::Encoding, formats::Type;
  formats::Head head;
  head.metadata = formats::to_json(metadata);
  head.channels = {{"position", Type::f32, 3, Encoding::plain},
                   {"distance", Type::f32, 1, Encoding::plain},
                   {"throughput", Type::f32, 3, Encoding::plain},
                   {"contribution", Type::f32, 3, Encoding::plain},
                   {"pixel", Type::u32, 1, Encoding::plain}};
  formats::Writer writer(path, head);

  constexpr std::size_t kPixels = kSize * kSize;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::exponential_distribution<double> exponential;
  std::vector<Vec3> position(kPixels);
  std::vector<Rgb> contribution(kPixels);
  const std::vector<float> distance(kPixels, 1.0f);
  const std::vector<Rgb> throughput(kPixels, Rgb(1, 1, 1));
  std::vector<std::uint32_t> pixel(kPixels);
  for (std::uint64_t pass = 0; pass < passes; ++pass) {
    for (std::size_t k = 0; k < kPixels; ++k) {
      const double x = (static_cast<double>(k % kSize) + uniform(random)) / kSize;
      const double y = (static_cast<double>(k / kSize) + uniform(random)) / kSize;
      const auto c = static_cast<float>(f(x) * exponential(random));
      position[k] = Vec3(static_cast<float>(x), static_cast<float>(y), 0);
      contribution[k] = Rgb(c, c, c);
      pixel[k] = static_cast<std::uint32_t>(k);
    }
    const void* columns[] = {position.data(), distance.data(), throughput.data(),
                             contribution.data(), pixel.data()};
    writer.append(kPixels, columns);
    writer.commit();
  }
  writer.close();
}

Rectangle Analytic::inside(double radius) {
  const auto margin = std::min(static_cast<std::size_t>(std::ceil(radius)) + 1, kSize / 2 - 1);
  return {margin, margin, kSize - 2 * margin, kSize - 2 * margin};
}

double Analytic::bias_sq(const filter::Radius& radius, std::uint64_t n, double epsilon,
                         const Rectangle& inside) const {
  double sum = 0;
  for (std::size_t column = inside.x; column < inside.x + inside.width; ++column) {
    const double truth = mean_over_pixel(column, [this](double x) { return f(x); });
    double filtered = 0;
    for (std::uint64_t pass = 1; pass <= n; ++pass) {
      const double r = filter::radius_scale(radius, static_cast<double>(pass)) / kSize;
      filtered += mean_over_pixel(column, [&](double x) { return f_over_disk(x, r); });
    }
    const double bias = filtered / static_cast<double>(n) - truth;
    sum += bias * bias / (truth * truth + epsilon);
  }
  return sum / static_cast<double>(inside.width);
}

double fitted_slope(const std::vector<double>& n, const std::vector<double>& values) {
  double x_mean = 0, y_mean = 0, xx = 0, xy = 0;
  const auto count = static_cast<double>(n.size());
  for (std::size_t k = 0; k < n.size(); ++k) {
    x_mean += std::log(n[k]) / count;
    y_mean += std::log(values[k]) / count;
  }
  for (std::size_t k = 0; k < n.size(); ++k) {
    const double x = std::log(n[k]) - x_mean;
    xx += x * x;
    xy += x * (std::log(values[k]) - y_mean);
  }
  return xy / xx;
}

}  // namespace psf::study
