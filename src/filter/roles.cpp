#include "filter/roles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
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
  kDirection,
  kRoughness
};

constexpr std::size_t kRoleGrain = 4096;

// One test for three: 0 times what is not finite is NaN.
bool all_finite(const Vec3& v) {
  return v.x * 0 + v.y * 0 + v.z * 0 == 0;
}

// The share of shaded records among those with a vertex; 1 where no record has a vertex.
double shaded_share(const Records& records) {
  struct Counts {
    std::uint64_t vertices = 0, shaded = 0;
  };
  std::vector<Counts> parts(core::range_count(records.size(), kRoleGrain));
  core::parallel_for(records.size(), kRoleGrain, [&](std::size_t begin, std::size_t end) {
    Counts& part = parts[begin / kRoleGrain];
    for (const std::uint8_t flags : records.flags.subspan(begin, end - begin)) {
      part.vertices += (flags & kHasVertex) != 0 ? 1u : 0u;
      part.shaded += (flags & kHasVertex) != 0 && (flags & kShaded) != 0 ? 1u : 0u;
    }
  });
  Counts all;
  for (const Counts& part : parts) {
    all.vertices += part.vertices;
    all.shaded += part.shaded;
  }
  return all.vertices == 0 ? 1
                           : static_cast<double>(all.shaded) / static_cast<double>(all.vertices);
}

// Whether a vertex was not shaded, nor a ray shot from it, so that its h is NaN.
bool lacks_hits(const Records& records) {
  std::vector<char> parts(core::range_count(records.size(), kRoleGrain), 0);
  core::parallel_for(records.size(), kRoleGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool unshaded = (records.flags[i] & (kHasVertex | kShaded)) == kHasVertex;
      if (unshaded && std::isnan(records.hit_distance[i])) parts[begin / kRoleGrain] = 1;
    }
  });
  return std::find(parts.begin(), parts.end(), 1) != parts.end();
}

class Classifier {
 public:
  Classifier(const Records& records, const Block& block, const Parameters& parameters)
      : r_(records),
        block_(block),
        k_(parameters.sources),
        shaded_share_(block.shade_rate > 1 ? 1 : shaded_share(records)),
        demodulate_(parameters.demodulate) {
    distance_ = needs_distance(parameters);
    for (const ChannelNeed& need : optional_channels(parameters)) {
      normal_ |= need.channel == kCheckedNames[kNormal];
      reflectance_ |= need.channel == kCheckedNames[kReflectance];
      hit_distance_ |= need.channel == kCheckedNames[kHitDistance];
      direction_ |= need.channel == kCheckedNames[kDirection];
      roughness_ |= need.channel == kCheckedNames[kRoughness];
    }
    normal_ &= records.taken != Taken::volumes;
    shaded_alone_ = hit_distance_ && lacks_hits(records);
    for (const CameraView& camera : block.cameras) {
      pixels_ += std::uint64_t{camera.width} * camera.height;
    }
  }

  // of[i] for records [begin, end), and what is counted of them.
  void classify(std::size_t begin, std::size_t end, std::span<Role> of,
                Statistics& statistics) const {
    std::size_t elsewhere = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const bool vertex = (r_.flags[i] & kHasVertex) != 0;
      if (vertex ? !r_.takes(i) : r_.taken == Taken::volumes) {
        of[i] = Role::left_out;  // of the other run, which counts it
        ++elsewhere;
        continue;
      }
      const bool source = vertex && is_source(i);
      const std::uint32_t bits = bad_channels(i, vertex, source);
      of[i] = bits != 0     ? Role::left_out
              : source      ? Role::source
              : vertex      ? Role::query
              : is_input(i) ? Role::no_vertex
                            : Role::unchosen;
      if (bits != 0) count(bits, statistics);
      statistics.queries += bits == 0 && vertex ? 1 : 0;
      statistics.sources += bits == 0 && source ? 1 : 0;
      statistics.without_vertex += bits == 0 && !vertex ? 1 : 0;
    }
    statistics.records += end - begin - elsewhere;
  }

 private:
  [[nodiscard]] bool is_source(std::size_t i) const {
    return (r_.flags[i] & kShaded) != 0 && (k_ == 1 || chosen(i));
  }
  // Whether record i, which has no vertex, would be a source if it had one.
  [[nodiscard]] bool is_input(std::size_t i) const {
    if (block_.shade_rate > 1) return is_source(i);
    if (shaded_share_ == 1) return k_ == 1 || chosen(i);
    return is_chosen(x_of(i), y_of(i), pass_of(i), shaded_share_ / k_);
  }
  // Whether record i, which has no vertex, would be shaded if it had one.
  [[nodiscard]] bool would_be_shaded(std::size_t i) const {
    if (block_.shade_rate > 1) return (r_.flags[i] & kShaded) != 0;
    return shaded_share_ == 1 || is_chosen(x_of(i), y_of(i), pass_of(i), shaded_share_);
  }
  [[nodiscard]] bool chosen(std::size_t i) const {
    return is_chosen(x_of(i), y_of(i), pass_of(i), k_);
  }
  [[nodiscard]] std::uint32_t x_of(std::size_t i) const { return r_.pixel[i] % width_of(i); }
  [[nodiscard]] std::uint32_t y_of(std::size_t i) const { return r_.pixel[i] / width_of(i); }
  [[nodiscard]] std::uint32_t width_of(std::size_t i) const {
    return block_.cameras[r_.camera.empty() ? 0 : r_.camera[i]].width;
  }
  [[nodiscard]] std::uint64_t pass_of(std::size_t i) const {
    return (block_.first_path + i) / pixels_;
  }

  static void count(std::uint32_t bits, Statistics& statistics) {
    ++statistics.left_out;
    for (std::size_t k = 0; k < kCheckedChannels; ++k) statistics.non_finite[k] += (bits >> k) & 1;
  }

  // Bit k set: the value of channel k of kCheckedNames is in use and not finite.
  [[nodiscard]] std::uint32_t bad_channels(std::size_t i, bool vertex, bool source) const {
    std::uint32_t bad = 0;
    const auto check = [&bad](bool good, Checked channel) {
      bad |= std::uint32_t{!good} << channel;
    };
    check(r_.unfiltered.empty() || all_finite(r_.unfiltered[i]), kUnfiltered);
    if (shaded_alone_) {
      check(vertex ? (r_.flags[i] & kShaded) != 0 : would_be_shaded(i), kHitDistance);
    }
    if (!vertex) return bad;
    check(all_finite(r_.throughput[i]), kThroughput);
    check(all_finite(r_.position[i]), kPosition);
    check(!distance_ || std::isfinite(r_.distance[i]), kDistance);
    check(!source || all_finite(r_.contribution[i]), kContribution);
    check(!normal_ || all_finite(r_.normal[i]), kNormal);
    check(!reflectance_ || all_finite(r_.reflectance[i]), kReflectance);
    check(!hit_distance_ || r_.hit_distance[i] >= std::numeric_limits<float>::lowest(),
          kHitDistance);  // +infinity is a miss
    check(!direction_ || all_finite(r_.direction[i]), kDirection);
    check(!roughness_ || std::isfinite(r_.roughness[i]), kRoughness);
    if (demodulate_ && source && bad == 0) {
      check(all_finite(demodulate(r_.contribution[i], r_.reflectance[i])), kReflectance);
    }
    return bad;
  }

  const Records& r_;
  const Block& block_;
  std::uint32_t k_;
  double shaded_share_;  // share of shaded paths, estimated from the records with a vertex
  bool demodulate_;
  bool distance_ = false, normal_ = false, reflectance_ = false, hit_distance_ = false,
       direction_ = false, roughness_ = false;
  bool shaded_alone_ = false;  // unshaded records are left out, with a vertex or without
  std::uint64_t pixels_ = 0;
};

}  // namespace

Roles find_roles(const Records& records, const Block& block, const Parameters& parameters,
                 Statistics& statistics) {
  Roles roles;
  roles.of.resize(records.size());
  const Classifier classifier(records, block, parameters);
  std::vector<Statistics> parts(core::range_count(records.size(), kRoleGrain));
  core::parallel_for(records.size(), kRoleGrain, [&](std::size_t begin, std::size_t end) {
    classifier.classify(begin, end, roles.of, parts[begin / kRoleGrain]);
  });
  std::vector<std::size_t> first_query, first_source;
  std::size_t queries = 0, sources = 0;
  for (const Statistics& part : parts) {
    first_query.push_back(queries);
    first_source.push_back(sources);
    queries += part.queries;
    sources += part.sources;
    statistics += part;
  }
  roles.queries.resize(queries);
  roles.sources.resize(sources);
  core::parallel_for(records.size(), kRoleGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* query = roles.queries.data() + first_query[begin / kRoleGrain];
    std::uint32_t* source = roles.sources.data() + first_source[begin / kRoleGrain];
    for (std::size_t i = begin; i < end; ++i) {
      const Role role = roles.of[i];
      if (role == Role::source) *source++ = static_cast<std::uint32_t>(i);
      if (role == Role::source || role == Role::query) *query++ = static_cast<std::uint32_t>(i);
    }
  });
  return roles;
}

}  // namespace psf::filter
