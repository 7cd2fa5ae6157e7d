#include "run/unfiltered_paths.h"

#include <vector>

#include "core/parallel.h"
#include "filter/parameters/parameters.h"
#include "filter/roles.h"
#include "run/block_loop.h"
#include "run/missing_terms.h"
#include "run/path_radiance.h"
#include "run/pixel_bands.h"

namespace psf::run {
namespace {

constexpr std::uint32_t kBlockExponent = 18;  // 2^18 paths, 25 MB

// Those of psf filter where nothing is said, as far as the dump has what they need.
filter::Parameters defaults_for(const Dump& dump) {
  filter::Parameters parameters;
  parameters.block.kind = filter::BlockSize::Kind::power;
  parameters.block.base = 2;
  parameters.block.exponent = kBlockExponent;
  // No angle per pixel is asked for. The distance is read all the same, where there is one.
  parameters.radius.basis =
      dump.find("distance") ? filter::RadiusBasis::distance : filter::RadiusBasis::world;
  static_cast<void>(switch_off_missing(dump, {&parameters, 1}, {}));
  return parameters;
}

UnfilteredPath path_of(const filter::Records& records, filter::Role role, std::size_t i) {
  UnfilteredPath path;
  path.camera = records.camera.empty() ? 0 : records.camera[i];
  path.pixel = records.pixel[i];
  path.in_picture = filter::is_input(role);
  path.radiance = Rgb(0, 0, 0);
  if (path.in_picture) {
    const Rgb u = unfiltered_of(records, i);
    path.radiance = role == filter::Role::source
                        ? path_radiance(u, records.throughput[i], records.contribution[i])
                        : u;
  }
  const bool vertex = filter::is_query(role);
  const auto feature = [&](const auto& column, auto none) {
    return vertex && !column.empty() ? column[i] : none;
  };
  path.reflectance = feature(records.reflectance, Rgb(0, 0, 0));
  path.normal = feature(records.normal, Vec3(0, 0, 0));
  path.distance = feature(records.distance, 0.0f);
  return path;
}

}  // namespace

UnfilteredCounts for_each_unfiltered_path(
    const Dump& dump, const PassSelection& passes,
    const std::function<void(std::span<const UnfilteredPath>)>& visit,
    const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  const std::size_t last = last_pass(dump, passes);
  const filter::Parameters parameters = defaults_for(dump);
  UnfilteredCounts counts;
  counts.passes = last - passes.first;
  BlockLoop blocks(dump, dump.select(parameters, true), parameters.block, parameters.radius.count,
                   passes.first);
  blocks.set_last(last, true);
  filter::Statistics statistics;
  const BlockLoop::Visitor visitor = [&](const BlockLoop::Visit& block) {
    core::undisturbed([&] {
      const std::vector<filter::Role> roles =
          filter::find_roles(block.records, block.block, parameters, statistics).of;
      struct Band {
        std::vector<UnfilteredPath> paths;
        std::uint64_t overflows = 0;
      };
      std::vector<Band> bands(pixel_bands());
      for_each_by_pixel(block.records, 0, block.records.size(),
                        [&](std::size_t b, std::span<const std::size_t> some) {
                          Band& band = bands[b];
                          band.paths.clear();
                          for (const std::size_t i : some) {
                            if (roles[i] == filter::Role::left_out) continue;
                            band.paths.push_back(path_of(block.records, roles[i], i));
                            const Rgb& radiance = band.paths.back().radiance;
                            if (is_finite(Vec3(radiance.x, radiance.y, radiance.z))) continue;
                            band.paths.pop_back();
                            ++band.overflows;
                          }
                          visit(band.paths);
                        });
      for (const Band& band : bands) counts.overflows += band.overflows;
    });
    if (progress) progress(block.paths.last - blocks.all().first, blocks.all().size());
  };
  if (blocks.visit_whole(visitor)) blocks.visit_rest(visitor);
  counts.paths = blocks.all().size();
  counts.left_out = statistics.left_out;
  return counts;
}

}  // namespace psf::run
