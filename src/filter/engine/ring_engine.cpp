#include "filter/engine/ring_engine.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "core/buffer.h"
#include "filter/engine/adopt.h"
#include "filter/engine/kernel.h"
#include "filter/sum.h"

namespace psf::filter::engine {

// Red, green, blue and a count; in the order of RingPacket's sums. A type of both compilers, which
// adds and multiplies four at once.
using Quadruple = double __attribute__((vector_size(4 * sizeof(double)), aligned(8), may_alias));

// What Statistics counts of queries, by radius, close together.
class QueryCounts {
 public:
  explicit QueryCounts(std::size_t radii)
      : accepted_(radii, 0),
        least_(radii, std::numeric_limits<std::uint32_t>::max()),
        most_(radii, 0) {}

  void add(std::size_t k, std::uint32_t neighbors) {
    accepted_[k] += neighbors;
    least_[k] = std::min(least_[k], neighbors);
    most_[k] = std::max(most_[k], neighbors);
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
        rings_(engine.table_.rings()),
        statistics_(statistics),
        visit_(visit),
        r_(kWidth * rings_),
        r_sq_(kWidth * rings_),
        sums_(kWidth * (rings_ + 1) * 4),
        whole_(rings_ * 4),
        average_(rings_),
        neighbors_(rings_),
        queries_(rings_) {}

  void add_counts() const { queries_.add_to(statistics_); }

  void average(std::span<const std::uint32_t> queries, std::span<const std::uint32_t> nodes,
               Packet& packet) {
    RingPacket rings{{}, r_.begin(), r_sq_.begin(), sums_.begin(), whole_.begin()};
    set_radii(queries, rings);
    std::fill(sums_.begin(), sums_.end(), 0.0);
    std::fill(whole_.begin(), whole_.end(), 0.0);
    average_rings(e_.packets_.tree(), p_.weights.terms(), e_.table_, nodes, packet, rings);
    for (std::size_t q = 0; q < queries.size(); ++q) {
      finish(queries[q], q, packet.met_itself[q] != 0);
    }
  }

 private:
  void set_radii(std::span<const std::uint32_t> queries, RingPacket& rings) {
    const std::span<const double> scales = e_.table_.scales();
    for (std::size_t q = 0; q < kWidth; ++q) {
      const double f = e_.basis_[queries[std::min(q, queries.size() - 1)]];
      const bool within = f * f >= RingTable::kLeastBasisSq && f * f <= RingTable::kLargestBasisSq;
      rings.inverse_basis_sq[q] =
          within ? static_cast<float>(1 / (f * f)) : std::numeric_limits<float>::quiet_NaN();
      float* r = &r_[q * rings_];
      float* r_sq = &r_sq_[q * rings_];
      for (std::size_t k = 0; k < rings_; ++k) {
        r[k] = static_cast<float>(scales[k] * f);
        r_sq[k] = r[k] * r[k];
      }
    }
  }

  // Query i, the q-th of its packet; `met`: the walk met i itself, in its first ring.
  void finish(std::uint32_t i, std::size_t q, bool met) {
    const bool source = e_.packets_.is_source(i);
    const float* r = &r_[q * rings_];
    // Whether i is in the sums of every radius that it must be in.
    const bool is_in = !source || (met && r_sq_[q * rings_] > 0);
    const bool simple = is_in && p_.area.empty();
    const auto* ring = reinterpret_cast<const Quadruple*>(&sums_[q * (rings_ + 1) * 4]);
    const auto* whole = reinterpret_cast<const Quadruple*>(whole_.begin());
    Quadruple ball = {0, 0, 0, 0};
    std::optional<Rgb> adopted;
    for (std::size_t k = 0; k < rings_; ++k) {
      ball += ring[k] + whole[k];
      const auto count = static_cast<std::uint32_t>(static_cast<std::int64_t>(ball[3]));
      if (simple && count > 0) {
        // One division for three: most of the time that is spent here. Of n equal values it is
        // that value too.
        const Quadruple mean = ball * (1 / ball[3]);
        average_[k] = Rgb(static_cast<float>(mean[0]), static_cast<float>(mean[1]),
                          static_cast<float>(mean[2]));
        neighbors_[k] = count;
      } else {
        finish_one(i, r[k], k, ball, source && !(met && r_sq_[q * rings_ + k] > 0), adopted);
      }
      queries_.add(k, neighbors_[k]);
    }
    visit_({i, {r, rings_}, average_, neighbors_});
  }

  // `add_own`: i is not in `ball`.
  void finish_one(std::uint32_t i, float r_i, std::size_t k, const Quadruple& ball, bool add_own,
                  std::optional<Rgb>& adopted) {
    const bool disk = !p_.area.empty();
    Sum sum{ball[0], ball[1], ball[2]};
    auto count = static_cast<std::uint32_t>(static_cast<std::int64_t>(ball[3]));
    if (add_own) {
      sum.add(e_.values_[i], disk ? double{p_.area[i]} : 1);
      ++count;
    }
    neighbors_[k] = count;
    average_[k] =
        count == 0 ? adopt_one(i, r_i, k, adopted) : estimate(sum, count, disk, r_i, e_.values_[i]);
  }

  // What an orphan averages depends on the radius only where `plane` does.
  Rgb adopt_one(std::uint32_t i, float r_i, std::size_t k, std::optional<Rgb>& before) {
    Statistics& counts = statistics_[k];
    if (!before || p_.weights.terms().plane) {
      const Packets& packets = e_.packets_;
      const Adopted adopted = adopt(packets.tree(), packets.index(), p_, i, r_i);
      matched_ = adopted.matched;
      before = average_of(adopted, e_.values_, counts);
    } else {
      ++counts.orphans;
      if (!matched_) ++counts.orphans_unmatched;
    }
    return *before;
  }

  const RingEngine& e_;
  const Problem& p_;
  std::size_t rings_;
  std::span<Statistics> statistics_;
  const std::function<void(const Results&)>& visit_;
  core::Buffer<float> r_, r_sq_;  // (16, rings)
  core::Buffer<double> sums_;     // (16, rings + 1, 4)
  core::Buffer<double> whole_;    // (rings, 4)
  std::vector<Rgb> average_;
  std::vector<std::uint32_t> neighbors_;
  QueryCounts queries_;
  bool matched_ = true;  // of the orphan that was adopted last
};

void RingEngine::set_values(std::span<const Rgb> values) {
  values_ = values;
  packets_.tree().set_values(values, p_.area);
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
