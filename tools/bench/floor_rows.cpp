#include "bench/floor_rows.h"

#include <fmt/format.h>

#include "bench/turns.h"
#include "core/parallel.h"
#include "filter/engine/floor.h"
#include "filter/engine/instruction_sets.h"

namespace psf::bench {
namespace {

using filter::engine::Floor;
using filter::engine::instruction_sets;
using filter::engine::InstructionSetLimit;

constexpr double kGiga = 1e9;
constexpr std::size_t kTimes = 20000;  // a tenth of a second or less

double seconds_on_floor(Floor& floor) {
  return seconds_of([&floor] { static_cast<void>(floor.run(kTimes)); });
}

double pairs_per_second(double seconds) {
  return static_cast<double>(kTimes * Floor::kPairs) / seconds;
}

Row floor_row(std::string name, std::string with, const filter::WeightTerms& terms,
              std::size_t repeat) {
  Floor floor(terms);
  std::vector<double> rates;
  for (std::size_t k = 0; k < repeat; ++k) {
    rates.push_back(pairs_per_second(seconds_on_floor(floor)) / kGiga);
  }
  return {std::move(name), "pair tests a second in the first-level cache, " + std::move(with),
          "G/s",           spread(rates),
          std::nullopt,    filter::engine::instruction_set() + ", 1 thread"};
}

// Seconds that a call returns, on a given set.
template <class Call>
auto on(const std::string& set, const Call& call) {
  return [&set, &call] {
    const InstructionSetLimit limit(set);
    return call();
  };
}

// A row for every set but the best: the time of `call` on the best over that on this one.
template <class Call>
std::vector<Row> rows_of_sets(const std::string& name, const std::string& what, std::size_t repeat,
                              const Call& call) {
  const std::vector<std::string> sets = instruction_sets();
  const std::string& best = sets.front();
  std::vector<Row> rows;
  for (std::size_t k = 1; k < sets.size(); ++k) {
    const Turns turns(repeat, on(best, call), on(sets[k], call));
    rows.push_back({fmt::format("{}_{}", name, sets[k]),
                    fmt::format("{} as fast as {}, {}", sets[k], best, what), "x", turns.ratio(),
                    std::nullopt, turns.detail()});
  }
  return rows;
}

}  // namespace

std::vector<Row> floor_rows(const Sample& sample, std::size_t repeat) {
  const core::ThreadLimit one(1);
  std::vector<Row> rows = {
      floor_row("floor_chi", "chi alone", filter::WeightTerms::none(), repeat),
      floor_row("floor_terms", "chi and terms", sample.parameters.weights, repeat)};
  Floor floor(sample.parameters.weights);
  const std::vector<Row> sets =
      rows_of_sets("floor_terms", "chi and terms", repeat, [&] { return seconds_on_floor(floor); });
  rows.insert(rows.end(), sets.begin(), sets.end());
  return rows;
}

Row floor_share_row(const Sample& sample, const Reach& reach, std::size_t repeat) {
  const core::ThreadLimit one(1);
  Floor floor(sample.parameters.weights);
  const Turns turns(
      repeat, [&] { return run_filter(sample, reach, filter::EngineKind::flann).seconds; },
      [&] { return seconds_on_floor(floor); });
  std::vector<double> shares;
  for (std::size_t k = 0; k < turns.first.size(); ++k) {
    const double pairs = reach.in_ball * static_cast<double>(sample.size());
    shares.push_back(pairs / turns.first[k] / pairs_per_second(turns.second[k]));
  }
  const double median = spread(turns.first).median;
  return {"floor_share",
          fmt::format("pairs in balls a second / the floor's tests, {:.0f} neighbours",
                      reach.neighbors),
          "x",
          spread(shares),
          std::nullopt,
          fmt::format("{:.3g} G/s; above 1: groups are taken or left whole",
                      reach.in_ball * static_cast<double>(sample.size()) / median / kGiga)};
}

std::vector<Row> instruction_set_rows(const Sample& sample, const Reach& reach,
                                      std::size_t repeat) {
  const core::ThreadLimit one(1);
  return rows_of_sets("set", fmt::format("whole filter, {:.0f} neighbours", reach.neighbors),
                      repeat,
                      [&] { return run_filter(sample, reach, filter::EngineKind::flann).seconds; });
}

}  // namespace psf::bench
