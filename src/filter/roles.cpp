#include "filter/roles.h"

#include <cmath>
#include <limits>

#include "filter/subsample.h"
#include "filter/values.h"

namespace psf::filter {
namespace {

// Indices in kCheckedNames.
enum Checked : std::uint32_t {
  kUnfiltered,
  kThroughput,
  kPosition,
  kDistance,
  kContribution,
  kNormal,
  kReflectance,
  kHitDistance,
  kDirection
};

class Classifier {
 public:
  Classifier(const Records& records, const Block& block, const Parameters& parameters)
      : r_(records), block_(block), k_(parameters.sources), demodulate_(parameters.demodulate) {
    const WeightTerms& weights = parameters.weights;
    const bool disk = parameters.estimator == Estimator::disk;
    distance_ = disk || parameters.radius.basis != RadiusBasis::world;
    normal_ = disk || weights.normal || weights.plane;
    reflectance_ = demodulate_ || weights.reflectance;
    hit_distance_ = weights.hit_distance.has_value();
    direction_ = disk || weights.direction;
    for (const CameraView& camera : block.cameras) {
      pixels_ += std::uint64_t{camera.width} * camera.height;
    }
  }

  [[nodiscard]] bool is_source(std::size_t i) const {
    return (r_.flags[i] & kShaded) != 0 && (k_ == 1 || chosen(i));
  }

  // Bit k set: the value of channel k of kCheckedNames is in use and not finite.
  [[nodiscard]] std::uint32_t bad_channels(std::size_t i, bool vertex, bool source) const {
    std::uint32_t bad = 0;
    const auto check = [&bad](bool in_use_and_bad, Checked channel) {
      bad |= std::uint32_t{in_use_and_bad} << channel;
    };
    check(!r_.unfiltered.empty() && !is_finite(r_.unfiltered[i]), kUnfiltered);
    if (!vertex) return bad;
    check(!is_finite(r_.throughput[i]), kThroughput);
    check(!is_finite(r_.position[i]), kPosition);
    check(distance_ && !std::isfinite(r_.distance[i]), kDistance);
    check(source && !is_finite(r_.contribution[i]), kContribution);
    check(normal_ && !is_finite(r_.normal[i]), kNormal);
    check(reflectance_ && !is_finite(r_.reflectance[i]), kReflectance);
    check(hit_distance_ && !(r_.hit_distance[i] >= std::numeric_limits<float>::lowest()),
          kHitDistance);
    check(direction_ && !is_finite(r_.direction[i]), kDirection);
    if (demodulate_ && source && bad == 0) {
      check(!is_finite(demodulate(r_.contribution[i], r_.reflectance[i])), kReflectance);
    }
    return bad;
  }

 private:
  [[nodiscard]] bool chosen(std::size_t i) const {
    const CameraView& camera = block_.cameras[r_.camera.empty() ? 0 : r_.camera[i]];
    const std::uint32_t x = r_.pixel[i] % camera.width, y = r_.pixel[i] / camera.width;
    return is_chosen(x, y, (block_.first_path + i) / pixels_, k_);
  }

  const Records& r_;
  const Block& block_;
  std::uint32_t k_;
  bool demodulate_;
  bool distance_, normal_, reflectance_, hit_distance_, direction_;
  std::uint64_t pixels_ = 0;
};

}  // namespace

Roles find_roles(const Records& records, const Block& block, const Parameters& parameters,
                 Statistics& statistics) {
  Roles roles;
  roles.of.resize(records.size());
  roles.queries.reserve(records.size());
  roles.sources.reserve(records.size());
  const Classifier classifier(records, block, parameters);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const bool vertex = (records.flags[i] & kHasVertex) != 0;
    const bool source = vertex && classifier.is_source(i);
    const std::uint32_t bad = classifier.bad_channels(i, vertex, source);
    if (bad != 0) {
      roles.of[i] = Role::left_out;
      ++statistics.left_out;
      for (std::size_t k = 0; k < kCheckedChannels; ++k) statistics.non_finite[k] += (bad >> k) & 1;
      continue;
    }
    roles.of[i] = source ? Role::source : vertex ? Role::query : Role::no_vertex;
    if (vertex) roles.queries.push_back(static_cast<std::uint32_t>(i));
    if (source) roles.sources.push_back(static_cast<std::uint32_t>(i));
  }
  statistics.records += records.size();
  statistics.queries += roles.queries.size();
  statistics.sources += roles.sources.size();
  statistics.without_vertex = statistics.records - statistics.queries - statistics.left_out;
  return roles;
}

}  // namespace psf::filter
