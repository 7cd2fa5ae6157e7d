#include "study/analytic_check.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <vector>

#include "core/error.h"
#include "core/unfinished.h"
#include "run/dump.h"

namespace psf::study {
namespace {

constexpr std::size_t kReplicates = 6;
constexpr std::uint64_t kPasses = 64;
constexpr std::uint64_t kFitFrom = 2;  // passes

std::vector<SlopeCheck> check_slopes(const Analytic& scene, std::span<const ConvergeSeries> series,
                                     double epsilon, const Rectangle& inside) {
  std::vector<SlopeCheck> checks;
  for (std::size_t k = 1; k < series.size(); ++k) {
    const filter::Radius& radius = series[k].parameters->radius;
    std::vector<double> n, bias_sq, variance, bias_sq_theory, variance_theory;
    for (const ConvergePoint& point : series[k].points) {
      if (point.n < kFitFrom) continue;
      n.push_back(static_cast<double>(point.n));
      bias_sq.push_back(point.parts.bias_sq);
      variance.push_back(point.parts.variance);
      bias_sq_theory.push_back(scene.bias_sq(radius, point.n, epsilon, inside));
      variance_theory.push_back(point.theory.variance);
    }
    const auto add = [&](const char* quantity, const std::vector<double>& measured,
                         const std::vector<double>& theory) {
      SlopeCheck check{k, quantity, fitted_slope(n, measured), fitted_slope(n, theory), false};
      check.passed = std::abs(check.measured - check.theory) <= kSlopeTolerance;
      checks.push_back(check);
    };
    add("bias_sq", bias_sq, bias_sq_theory);
    add("variance", variance, variance_theory);
  }
  return checks;
}

// Dumps of a scene in a folder of their own, there as long as they are needed, whatever happens.
class Replicates {
 public:
  Replicates(const Analytic& scene, const std::filesystem::path& around)
      : folder_((around / fmt::format(".{}.partial", getpid())).string()), own_folder_(folder_) {
    std::filesystem::create_directory(folder_);
    for (std::size_t r = 0; r < kReplicates; ++r) {
      dumps_.push_back(fmt::format("{}/{}.pvb", folder_, r));
      own_dumps_.emplace_back(dumps_.back());
      scene.write_dump(dumps_.back(), r + 1, kPasses);
    }
  }
  [[nodiscard]] const std::vector<std::string>& dumps() const { return dumps_; }

 private:
  std::string folder_;
  std::vector<std::string> dumps_;
  core::Unfinished own_folder_;
  std::deque<core::Unfinished> own_dumps_;
};

}  // namespace

ConvergeReport check_analytic(
    AnalyticScene which, std::span<const filter::Parameters> sets, const std::string& folder,
    const std::function<void(std::uint64_t done, std::uint64_t total)>& on_progress) {
  const Analytic scene(which);
  double largest = 0;
  std::vector<filter::Parameters> fitting(sets.begin(), sets.end());
  for (filter::Parameters& set : fitting) {
    if (set.fit != filter::BallFit::mean) {
      throw Error(ErrorCode::usage, "`fit`: the theory is that of means; give `fit mean`");
    }
    if (!set.fireflies.keeps()) {
      throw Error(ErrorCode::usage, "`fireflies`: the theory knows none; give `fireflies keep`");
    }
    if (set.pixels != filter::PixelRule::keep) {
      throw Error(ErrorCode::usage,
                  "`pixels`: the theory is that of the first pass; give `pixels keep`");
    }
    set.block = {filter::BlockSize::Kind::passes, 2, 16, 1};
    set.weights = filter::WeightTerms::none();
    set.radius.basis = filter::RadiusBasis::footprint;
    largest = std::max(largest, set.radius.r0);
  }
  const Replicates replicates(scene, folder);
  const std::vector<Rgb> picture = scene.reference();
  const metrics::MetricOptions options;
  const metrics::Reference reference(picture, Analytic::kSize, options, metrics::kPixelMetrics);
  ConvergeRequest request;
  request.sets = fitting;
  request.n = powers_up_to(kPasses);
  request.with_times = false;
  request.region = Analytic::inside(largest);
  request.on_progress = on_progress;
  ConvergeReport report;
  report.measured = metrics::kPixelMetrics;
  report.metrics = describe_metrics(report.measured, options);
  report.reference = describe_reference("closed form", picture);
  for (const std::string& path : replicates.dumps()) {
    Json input = describe_input(run::Dump(path), {}, 0);
    input["file"] = std::filesystem::path(path).filename().string();  // its folder is temporary
    report.inputs.push_back(std::move(input));
  }
  report.series = converge(replicates.dumps(), reference, picture, request);
  report.checks = check_slopes(scene, report.series, options.epsilon, request.region);
  return report;
}

}  // namespace psf::study
