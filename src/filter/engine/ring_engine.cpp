#include "filter/engine/ring_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/buffer.h"
#include "filter/engine/adopt.h"
#include "filter/engine/kernel.h"
#include "filter/sum.h"

namespace psf::filter::engine {

// What Statistics counts of queries, by radius, close together.
class QueryCounts {
 public:
  explicit QueryCounts(std::size_t radii)
      : accepted_(radii, 0),
        least_(radii, std::numeric_limits<std::uint32_t>::max()),
        most_(radii, 0) {}

  void add(std::span<const std::uint32_t> neighbors) {
    for (std::size_t k = 0; k < neighbors.size(); ++k) {
      accepted_[k] += neighbors[k];
      least_[k] = std::min(least_[k], neighbors[k]);
      most_[k] = std::max(most_[k], neighbors[k]);
    }
  }
  void add_to(std::span<Statistics> statistics) const {
    for (std::size_t k = 0; k < statistics.size(); ++k) {
      Statistics& one = statistics[k];
      one.accepted += accepted_[k];
      one.min_neighbors = std::min<std::uint64_t>(one.min_neighbors, least_[k]);
      one.max_neighbors = std::max<std::uint64_t>(one.max_neighbors, most_[k]);
    }
  }

 private:
  std::vector<std::uint64_t> accepted_;
  std::vector<std::uint32_t> least_, most_;
};

// Works on packets one after the other with memory of its own.
class RingEngine::Range {
 public:
  Range(const RingEngine& engine, std::span<Statistics> statistics,
        const std::function<void(const Results&)>& visit)
      : e_(engine),
        p_(engine.p_),
        rings_(engine.scales_.size()),
        statistics_(statistics),
        visit_(visit),
        r_sq_(kWidth * rings_),
        least_r_sq_(padded(rings_)),
        greatest_r_sq_(padded(rings_)),
        plane_reach_(p_.weights.terms().plane ? kWidth * rings_ : 0),
        sums_(kWidth * (rings_ + 1) * 4),
        whole_(rings_ * 4),
        balls_(rings_ * 4),
        inverse_(padded(rings_)),
        neighbors_(rings_),
        average_(rings_ + 1),
        queries_(rings_) {
    std::fill(inverse_.begin(), inverse_.end(), 1.0);
  }

  void add_counts() const { queries_.add_to(statistics_); }

  void average(std::span<const std::uint32_t> queries, std::span<const std::uint32_t> nodes,
               Packet& packet) {
    set_radii(queries);
    std::fill(sums_.begin(), sums_.end(), 0.0);
    std::fill(whole_.begin(), whole_.end(), 0.0);
    const RingPacket rings{rings_,
                           r_sq_.begin(),
                           least_r_sq_.begin(),
                           greatest_r_sq_.begin(),
                           plane_reach_.begin(),
                           sums_.begin(),
                           whole_.begin()};
    add_to_rings(e_.packets_.tree(), *e_.sums_, p_.weights.terms(), nodes, packet, rings);
    for (std::size_t q = 0; q < queries.size(); ++q) {
      finish(queries[q], q, rings, packet.met_itself[q] != 0);
    }
  }

 private:
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  static std::size_t padded(std::size_t rings) { return (rings + kWidth - 1) / kWidth * kWidth; }

  static float squared(float r) { return std::max(0.0f, r * r); }  // NaN: of an empty ball

  void set_radii(std::span<const std::uint32_t> queries) {
    double f[kWidth];
    for (std::size_t q = 0; q < kWidth; ++q) {
      f[q] = e_.basis_[queries[std::min(q, queries.size() - 1)]];
    }
    const bool finite = std::all_of(f, f + kWidth, [](double v) { return std::isfinite(v); });
    const auto [least, greatest] = std::minmax_element(f, f + kWidth);
    const float reach = p_.weights.terms().plane.value_or(0);
    for (std::size_t k = 0; k < rings_; ++k) {
      const double scale = e_.scales_[k];
      float* r_sq = &r_sq_[k * kWidth];
      for (std::size_t q = 0; q < kWidth; ++q) r_sq[q] = squared(static_cast<float>(scale * f[q]));
      least_r_sq_[k] = finite ? squared(static_cast<float>(scale * *least)) : 0;
      greatest_r_sq_[k] = finite ? squared(static_cast<float>(scale * *greatest)) : kInfinity;
      for (std::size_t q = 0; q < kWidth && plane_reach_.size() > 0; ++q) {
        const float of_q = reach * static_cast<float>(scale * f[q]);
        plane_reach_[k * kWidth + q] = std::isnan(of_q) ? -1 : of_q;
      }
    }
    std::fill(least_r_sq_.begin() + rings_, least_r_sq_.end(), kInfinity);
    std::fill(greatest_r_sq_.begin() + rings_, greatest_r_sq_.end(), kInfinity);
  }

  // Query i, the q-th of its packet; `met`: the walk met i itself, in its first ring.
  void finish(std::uint32_t i, std::size_t q, const RingPacket& rings, bool met) {
    const bool source = e_.packets_.is_source(i);
    // Whether i is in the sums of every radius that it must be in.
    const bool is_in = !source || (met && r_sq_[q] > 0);
    const bool simple = is_in && p_.area.empty();
    average_balls(rings, q, {&average_[0].x, neighbors_.begin(), balls_.begin(), inverse_.begin()});
    std::optional<Rgb> adopted;
    for (std::size_t k = 0; k < rings_ && !(simple && neighbors_[k] > 0); ++k) {
      finish_one(i, k, source && !(met && r_sq_[k * kWidth + q] > 0), adopted);
    }
    const std::span<const std::uint32_t> neighbors(neighbors_.begin(), rings_);
    queries_.add(neighbors);
    visit_({i, std::span(average_).first(rings_), neighbors, {balls_.begin(), 4 * rings_}});
  }

  // `add_own`: i is not in the ball.
  void finish_one(std::uint32_t i, std::size_t k, bool add_own, std::optional<Rgb>& adopted) {
    const bool disk = !p_.area.empty();
    const float r_i = e_.radius(i, k);
    double* ball = &balls_[4 * k];
    Sum sum{ball[0], ball[1], ball[2]};
    std::uint32_t count = neighbors_[k];
    if (add_own) {
      sum.add(e_.values_[i], disk ? double{p_.area[i]} : 1);
      ball[0] = sum.x;
      ball[1] = sum.y;
      ball[2] = sum.z;
      ++count;
    }
    neighbors_[k] = count;
    average_[k] =
        count == 0 ? adopt_one(i, r_i, k, adopted) : quotient(sum, count, disk, r_i, e_.values_[i]);
  }

  // What an orphan averages depends on the radius only where `plane` does.
  Rgb adopt_one(std::uint32_t i, float r_i, std::size_t k, std::optional<Rgb>& before) {
    if (p_.sources_apart) return {0, 0, 0};
    if (!before || p_.weights.terms().plane) {
      const Packets& packets = e_.packets_;
      const Adopted adopted = adopt(packets.tree(), packets.index(), p_, i, r_i);
      matched_ = adopted.matched;
      before = mean_of(adopted, e_.values_);
    }
    statistics_[k].add_orphan(matched_);
    return *before;
  }

  const RingEngine& e_;
  const Problem& p_;
  std::size_t rings_;
  std::span<Statistics> statistics_;
  const std::function<void(const Results&)>& visit_;
  core::Buffer<float> r_sq_, least_r_sq_, greatest_r_sq_, plane_reach_;  // as RingPacket has them
  core::Buffer<double> sums_;                                            // (rings + 1, 16, 4)
  core::Buffer<double> whole_;                                           // (rings, 4)
  // The RingMeans of the query at hand.
  core::Buffer<double> balls_, inverse_;
  core::Buffer<std::uint32_t> neighbors_;
  std::vector<Rgb> average_;
  QueryCounts queries_;
  bool matched_ = true;  // Adopted::matched of the last orphan
};

void RingEngine::set_values(std::span<const Rgb> values) {
  values_ = values;
  sums_.emplace(packets_.tree(), values, p_.area);
}

void RingEngine::average(std::size_t begin, std::size_t end, std::span<Statistics> statistics,
                         const std::function<void(const Results&)>& visit) const {
  Range range(*this, statistics, visit);
  packets_.each(begin, end, [&](auto queries, auto nodes, Packet& packet) {
    range.average(queries, nodes, packet);
  });
  range.add_counts();
}

}  // namespace psf::filter::engine
