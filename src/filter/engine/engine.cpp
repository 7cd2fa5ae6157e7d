#include "filter/engine/engine.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/engine/adopt.h"
#include "filter/engine/kernel.h"
#include "filter/engine/packets.h"
#include "filter/sum.h"

namespace psf::filter::engine {
namespace {

class TreeEngine final : public Engine {
 public:
  explicit TreeEngine(const Problem& problem) : p_(problem), packets_(problem) {}

  [[nodiscard]] bool is_moderate() const { return packets_.is_moderate(); }

  void apply(std::span<const Averaged> all, BallFit ball_fit, bool count_refusals,
             std::span<std::uint32_t> neighbors, Statistics& statistics) override {
    const Tree& tree = packets_.tree();
    const WeightTerms& terms = p_.weights.terms();
    std::vector<TreeSums> sums;
    for (const Averaged& one : all) sums.emplace_back(tree, one.values, p_.area);
    const bool fits = ball_fit == BallFit::linear;
    if (fits && !fit_sources_) fit_sources_.emplace(tree, p_.records);
    if (fits) fit_sources_->set_luminance(tree, all[0].values);
    const std::size_t size = packets_.order().size();
    std::vector<Statistics> parts(core::range_count(size, Packets::kGrain));
    core::parallel_for(size, Packets::kGrain, [&](std::size_t begin, std::size_t end) {
      core::throw_if_interrupted("no picture was written");
      Statistics& counts = parts[begin / Packets::kGrain];
      Found found;
      Fitting fitting;
      const std::size_t rows = 3 * all.size();
      const bool lists = all.size() > 1 || fits;
      core::Buffer<double> several(lists ? rows * kWidth : 0);
      if (fits) fitting.beside = core::Buffer<double>(rows * kWidth);
      core::Buffer<float> means(p_.area.empty() ? rows * kWidth : 0);
      packets_.each(begin, end, [&](auto queries, auto nodes, Packet& packet) {
        double* added = packet.sum[0];
        if (lists) {
          find_sources(tree, terms, nodes, packet, found);
          add_found(sums, found, several.begin());
          added = several.begin();
        } else {
          add_sources(tree, sums[0], terms, nodes, packet);
        }
        add_own(queries, packet, all, added);
        for (std::size_t k = 0; k < queries.size(); ++k) {
          neighbors[queries[k]] = static_cast<std::uint32_t>(packet.count[k]);
        }
        if (fits) {
          fit(queries, packet, found, sums, added, all, fitting);
        } else if (p_.area.empty()) {
          average_sums(packet, {added, rows * kWidth}, means.begin());
          put_averages(queries, packet, means.begin(), all);
        } else {
          put_over_disks(queries, packet, added, all);
        }
        if (count_refusals) count(queries, nodes, packet, counts);
        for (const std::uint32_t i : queries) {
          counts.add_query(neighbors[i]);
          if (neighbors[i] > 0) continue;
          if (p_.sources_apart) {
            for (const Averaged& one : all) one.out[i] = Rgb(0, 0, 0);
            continue;
          }
          average_adopted(adopt(tree, packets_.index(), p_, i, p_.radius[i]), i, all, counts);
        }
      });
    });
    for (const Statistics& part : parts) statistics += part;
  }

 private:
  // What [fit] of a packet needs.
  struct Fitting {
    FitPacket packet;
    core::Buffer<double> beside;  // (values, 3, 16), beside the mean
  };

  // Whether the walk did not meet the k-th query, i, of a packet, though it is a source.
  [[nodiscard]] bool is_own_apart(const Packet& packet, std::size_t k, std::uint32_t i) const {
    return packet.met_itself[k] == 0 && packets_.is_source(i);
  }

  // Adds to the sums, (values, 3, 16), and counts the queries that the walk did not meet: i is a
  // source like any other, and w_ii = 1 whatever the terms say.
  void add_own(std::span<const std::uint32_t> queries, Packet& packet,
               std::span<const Averaged> all, double* sums) const {
    for (std::size_t k = 0; k < queries.size(); ++k) {
      const std::uint32_t i = queries[k];
      if (!is_own_apart(packet, k, i)) continue;
      ++packet.count[k];
      const double weight = p_.area.empty() ? 1 : double{p_.area[i]};
      double* sum = sums + k;
      for (const Averaged& one : all) {
        const Rgb& own = one.values[i];
        for (const float component : {own.x, own.y, own.z}) {
          *sum += weight * double{component};
          sum += kWidth;
        }
      }
    }
  }

  // The averages, (values, 3, 16), of the queries that have a neighbour.
  static void put_averages(std::span<const std::uint32_t> queries, const Packet& packet,
                           const float* means, std::span<const Averaged> all) {
    for (const Averaged& one : all) {
      for (std::size_t k = 0; k < queries.size(); ++k) {
        if (packet.count[k] == 0) continue;
        one.out[queries[k]] = Rgb(means[k], means[kWidth + k], means[2 * kWidth + k]);
      }
      means += 3 * kWidth;
    }
  }

  // The same for [fit]; `sums` are those of the values, and hold all that is averaged.
  void fit(std::span<const std::uint32_t> queries, const Packet& packet, const Found& found,
           std::span<const TreeSums> values, const double* sums, std::span<const Averaged> all,
           Fitting& fitting) const {
    FitPacket& of = fitting.packet;
    of.set_axes(p_.records, queries, p_.radius);
    find_moments(packets_.tree(), *fit_sources_, found, packet, of);
    for (std::size_t k = 0; k < kWidth; ++k) {
      const double count = packet.count[k];
      const std::uint32_t i = queries[std::min(k, queries.size() - 1)];
      const Sum sum{sums[k], sums[kWidth + k], sums[2 * kWidth + k]};
      const float mean = count > 0 ? luminance(sum.over(count)) : 0;
      const float own = is_own_apart(packet, k, i) ? luminance(all[0].values[i]) : 0;
      of.luminance_sq[k] += double{own} * double{own};
      of.set_fit(k, count, count * double{mean});
    }
    double* beside = fitting.beside.begin();
    add_by_weight(packets_.tree(), *fit_sources_, values, found, packet, of, beside);
    put_fits(queries, packet, of, sums, beside, all);
  }

  void put_fits(std::span<const std::uint32_t> queries, const Packet& packet, const FitPacket& of,
                const double* sums, const double* beside, std::span<const Averaged> all) const {
    const auto colour = [](const double* rows) {
      return Sum{rows[0], rows[kWidth], rows[2 * kWidth]};
    };
    for (std::size_t k = 0; k < queries.size(); ++k) {
      const std::uint32_t i = queries[k];
      if (packet.count[k] == 0) continue;
      std::optional<FitShares> shares;
      for (std::size_t v = 0; v < all.size(); ++v) {
        Sum mean, difference = colour(beside + 3 * kWidth * v + k);
        mean.add(colour(sums + 3 * kWidth * v + k), 1.0 / packet.count[k]);
        if (is_own_apart(packet, k, i)) difference.add(all[v].values[i], double{of.at_mean[k]});
        if (!shares) shares.emplace(mean, difference);
        all[v].out[i] = shares->taken(mean, difference);
      }
    }
  }

  // The same for [disk], from the sums.
  void put_over_disks(std::span<const std::uint32_t> queries, const Packet& packet,
                      const double* sums, std::span<const Averaged> all) const {
    for (const Averaged& one : all) {
      for (std::size_t k = 0; k < queries.size(); ++k) {
        if (packet.count[k] == 0) continue;
        const std::uint32_t i = queries[k];
        const Sum sum{sums[k], sums[kWidth + k], sums[2 * kWidth + k]};
        const auto count = static_cast<std::uint32_t>(packet.count[k]);
        one.out[i] = quotient(sum, count, true, p_.radius[i], one.values[i]);
      }
      sums += 3 * kWidth;
    }
  }

  void count(std::span<const std::uint32_t> queries, std::span<const std::uint32_t> nodes,
             const Packet& packet, Statistics& statistics) const {
    PairCounts counts;
    count_pairs(packets_.tree(), p_.weights.terms(), nodes, packet, counts);
    statistics.candidates += counts.candidates;
    for (std::size_t k = 0; k < kTermCount; ++k) statistics.refused[k] += counts.refused[k];
    for (const std::uint32_t i : queries) {
      if (p_.roles.of[i] != Role::source) continue;
      const float r_i = p_.radius[i];
      if (!search::chi_ball(0, r_i * r_i)) {
        ++statistics.candidates;
        continue;
      }
      const std::uint32_t refusers = p_.weights.refusers(i, i, r_i);
      for (std::size_t k = 0; k < kTermCount; ++k) statistics.refused[k] -= (refusers >> k) & 1;
    }
  }

  const Problem& p_;
  Packets packets_;
  std::optional<FitSources> fit_sources_;  // once [fit] was asked for
};

}  // namespace

PairCounts& PairCounts::operator+=(const PairCounts& other) {
  candidates += other.candidates;
  for (std::size_t k = 0; k < kTermCount; ++k) refused[k] += other.refused[k];
  return *this;
}

std::unique_ptr<Engine> make(const Problem& problem) {
  auto engine = std::make_unique<TreeEngine>(problem);
  if (!engine->is_moderate()) return nullptr;
  return engine;
}

}  // namespace psf::filter::engine
