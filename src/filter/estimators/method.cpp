#include "filter/estimators/method.h"

#include <utility>

#include "core/parallel.h"
#include "core/seconds.h"
#include "filter/fireflies.h"
#include "filter/inputs.h"

namespace psf::filter {
namespace {

constexpr std::size_t kRecordsARange = 4096;

using core::Clock;
using core::seconds_since;

// What is averaged of the records, and their averages: c, and the contributions of the layers.
class Averages {
 public:
  // Takes room in `result`, which must outlive it.
  Averages(const MethodInput& input, const Roles& roles, Estimates& result)
      : input_(input), roles_(roles), result_(result) {
    const Records& records = input.records;
    result.neighbors.assign(records.size(), 0);
    result.layers.resize(records.layers.size());
    parts_.push_back({records.contribution, &result.c_bar, {}, {}});
    for (std::size_t k = 0; k < records.layers.size(); ++k) {
      if (records.layers[k].contribution.empty()) continue;
      parts_.push_back({records.layers[k].contribution, &result.layers[k], {}, {}});
    }
    for (const Part& part : parts_) part.c_bar->resize(records.size());  // Rgb has no first value
    blacken([](Role role) { return !is_query(role); });
  }

  // What an engine does not write: 0 for the records with such a role.
  template <class Wanted>
  void blacken(const Wanted& wanted) {
    core::parallel_for(roles_.of.size(), kRecordsARange, [&](std::size_t begin, std::size_t end) {
      std::vector<std::size_t> some;
      for (std::size_t i = begin; i < end; ++i) {
        if (wanted(roles_.of[i])) some.push_back(i);
      }
      for (const Part& part : parts_) {
        for (const std::size_t i : some) (*part.c_bar)[i] = Rgb(0, 0, 0);
      }
    });
  }

  // Divides by rho where the parameters say so.
  void demodulate() {
    if (!input_.parameters.demodulate) return;
    for (Part& part : parts_) part.given = demodulated(part.contribution, input_.records, roles_);
  }
  // Leaves what fireflies do not keep out of the values, and where it is spread, sets apart what every
  // query is given of it.
  void set_apart(const Fireflies& fireflies) {
    for (Part& part : parts_) {
      const std::span<const Rgb> all = values(part);
      if (fireflies.gives()) {
        part.gifts.resize(all.size());
        fireflies.give(all, part.gifts);
      }
      if (part.given.empty()) part.given.assign(all.begin(), all.end());
      for (const Firefly& one : fireflies.all()) part.given[one.record] *= one.kept;
    }
  }
  // The values that are averaged of c.
  [[nodiscard]] std::span<const Rgb> values() const { return values(parts_[0]); }

  void apply(Engine& engine, bool count_refusals, Statistics& statistics) {
    std::vector<Averaged> all;
    for (const Part& part : parts_) all.push_back({values(part), *part.c_bar});
    engine.apply(all, input_.parameters.fit, count_refusals, result_.neighbors, statistics);
  }
  // Applies the engine to the averages.
  void apply_again(Engine& engine) {
    for (Part& part : parts_) {
      std::swap(part.given, *part.c_bar);
      part.c_bar->resize(input_.records.size(), Rgb(0, 0, 0));
    }
    Statistics repeated;  // the same neighbours: counted once
    apply(engine, false, repeated);
  }

  // Applies finished() to the averages of every query that it may change: without demodulation
  // those of one source, which is no firefly. Then adds what fireflies give.
  void finish(std::span<const float> radius) {
    const std::span<const std::uint32_t> queries = roles_.queries;
    core::parallel_for(queries.size(), kRecordsARange, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> some;
      for (const std::uint32_t i : queries.subspan(begin, end - begin)) {
        if (input_.parameters.demodulate || result_.neighbors[i] == 1) some.push_back(i);
      }
      for (Part& part : parts_) {
        for (const std::uint32_t i : some) {
          Rgb& c_bar = (*part.c_bar)[i];
          c_bar = finished(c_bar, result_.neighbors[i], roles_.of[i] == Role::source, radius[i],
                           part.contribution[i], input_.records, i, input_.parameters);
        }
        add_gifts(part, queries.subspan(begin, end - begin));
      }
    });
    result_.given = std::move(parts_[0].gifts);
  }

 private:
  struct Part {
    std::span<const Rgb> contribution;
    std::vector<Rgb>* c_bar;  // in the result
    std::vector<Rgb> given;   // to the engine in place of `contribution`; empty: nothing was
    std::vector<Rgb> gifts;   // of fireflies, which come to the averages; empty: none
  };
  static std::span<const Rgb> values(const Part& part) {
    return part.given.empty() ? part.contribution : std::span<const Rgb>(part.given);
  }

  void add_gifts(Part& part, std::span<const std::uint32_t> some) const {
    if (part.gifts.empty()) return;
    const bool demodulate = input_.parameters.demodulate;
    for (const std::uint32_t i : some) {
      Rgb& gift = part.gifts[i];
      if (demodulate) gift = remodulate(gift, input_.records.reflectance[i]);
      (*part.c_bar)[i] += gift;
    }
  }

  const MethodInput& input_;
  const Roles& roles_;
  Estimates& result_;
  std::vector<Part> parts_;
};

}  // namespace

Estimates apply_engine(const MethodInput& input, const EngineSteps& steps) {
  const auto& [records, given, block, parameters, found] = input;
  Estimates result;
  const auto start = Clock::now();
  Roles roles = find_roles(records, block, parameters, result.statistics);
  Averages averages(input, roles, result);
  if (roles.sources.empty()) {
    averages.blacken([](Role) { return true; });
    result.roles = std::move(roles.of);
    leave_out_queries(result.roles, result.statistics);
    return result;
  }
  std::vector<float> area;
  if (steps.areas != nullptr) area = steps.areas(records, roles, block);
  const Weights weights(records, terms_in_use(records, parameters.weights));
  averages.demodulate();
  Problem problem{records, roles, given, weights, area};
  std::unique_ptr<Engine> engine;
  double seconds_of_fireflies = 0;
  if (!parameters.fireflies.keeps()) {
    engine = steps.engine(problem, block, parameters);
    const auto fireflies_start = Clock::now();
    Fireflies fireflies(problem, *engine, averages.values(), parameters, block.n);
    averages.set_apart(fireflies);
    fireflies.add_to(result.statistics);
    if (found != nullptr) *found = std::move(fireflies);
    seconds_of_fireflies = seconds_since(fireflies_start);
  }
  if (steps.radii != nullptr) {
    engine.reset();  // it is of other radii
    result.radius = steps.radii(problem, averages.values(), parameters);
    problem.radius = result.radius;
  }
  if (!engine) engine = steps.engine(problem, block, parameters);
  result.statistics.seconds_index = seconds_since(start) - seconds_of_fireflies;

  const auto filter_start = Clock::now();
  averages.apply(*engine, parameters.count_refusals, result.statistics);
  for (std::uint32_t k = 1; k < parameters.iterations; ++k) averages.apply_again(*engine);
  averages.finish(problem.radius);
  result.roles = std::move(roles.of);
  result.statistics.seconds_filter = seconds_since(filter_start) + seconds_of_fireflies;
  return result;
}

std::unique_ptr<Engine> ball_engine(const Problem& problem, const Block&,
                                    const Parameters& parameters) {
  return make_engine(parameters.engine, problem);
}

void leave_out_queries(std::span<Role> roles, Statistics& statistics) {
  for (Role& role : roles) {
    if (role == Role::query) role = Role::left_out;
  }
  statistics.without_source = statistics.queries;
}

}  // namespace psf::filter
