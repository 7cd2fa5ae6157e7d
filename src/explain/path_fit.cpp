#include "explain/path_fit.h"

#include <array>
#include <cmath>

#include "filter/fit.h"

namespace psf::explain {

std::optional<PathFit> fit_path(const filter::Records& all, std::uint32_t i, float r_i,
                                std::span<const FitSource> sources) {
  if (sources.size() < 2) return std::nullopt;
  filter::Records records = all;
  records.taken = all.in_volume(i) ? filter::Taken::volumes : filter::Taken::surfaces;
  const filter::FitAxes axes = fit_axes(records, i, r_i);
  const std::span<const Vec3> x = records.position, y = facing(records);
  filter::FitMoments moments;
  std::vector<std::array<double, filter::kFeatures>> features;
  for (const auto& [j, value] : sources) {
    features.push_back(filter::features(axes, x[j] - x[i], y[j] - y[i]));
    moments.add(features.back(), double{luminance(value)});
  }
  const filter::Fit fit = fit_of(moments);
  if (!std::isfinite(fit.ridge)) return std::nullopt;
  PathFit path;
  filter::Sum mean, beside;
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const double weight = fit.weight(features[k]);
    path.beside.push_back(static_cast<float>(weight));
    mean.add(sources[k].value, 1 / moments.count);
    beside.add(sources[k].value, weight);
  }
  const filter::FitShares shares(mean, beside);
  const auto [red, green, blue] = shares.each();
  path.of = {fit.ridge, {mean.x, mean.y, mean.z}, {red, green, blue}};
  path.value = wide(shares.taken(mean, beside));
  return path;
}

}  // namespace psf::explain
