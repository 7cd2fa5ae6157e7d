#include "bench/sample.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "filter/channels.h"
#include "filter/inputs.h"

namespace psf::bench {
namespace {

filter::Parameters parameters_for(const run::Dump& dump) {
  const auto has = [&dump](const char* channel) {
    return dump.reader().head().find(channel).has_value();
  };
  filter::Parameters parameters;
  parameters.radius.delta = 0;
  const bool angles = std::all_of(dump.cameras().begin(), dump.cameras().end(),
                                  [](const auto& camera) { return camera.angle_per_pixel > 0; });
  if (!angles) parameters.radius.basis = filter::RadiusBasis::distance;
  if (!has("normal")) parameters.weights.normal.reset();
  if (!has("reflectance")) parameters.weights.reflectance.reset();
  if (!has("visibility")) parameters.weights.visibility = false;
  if (!has("normal") || !has("direction") || !has("roughness")) parameters.weights.gloss.reset();
  return parameters;
}

}  // namespace

Sample read_sample(const run::Dump& dump, std::size_t records) {
  Sample sample;
  sample.cameras = dump.cameras();
  sample.parameters = parameters_for(dump);
  const std::uint64_t count = std::min(std::uint64_t{records}, dump.reader().records());
  dump.read({0, count}, dump.select(sample.parameters, false), sample.records);
  sample.parameters.weights =
      filter::terms_in_use(sample.records.view(), sample.parameters.weights);
  for (const std::uint64_t bound : dump.pass_bounds()) {
    if (bound <= count) sample.passes.push_back(bound);
  }
  if (std::none_of(sample.records.flags.begin(), sample.records.flags.end(),
                   [](std::uint8_t flags) { return (flags & filter::kHasVertex) != 0; })) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: none of the first {} records has a vertex; take more --records",
                            dump.reader().path(), count));
  }
  return sample;
}

filter::Records part(const filter::Records& records, std::size_t first, std::size_t last) {
  filter::Records cut;
  filter::for_each_channel([&](const char*, const auto& member) {
    if (!member(records).empty()) member(cut) = member(records).subspan(first, last - first);
  });
  return cut;
}

}  // namespace psf::bench
