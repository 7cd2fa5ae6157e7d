// Every instruction set and any number of threads give the same bytes.
#include "filter/engine/instruction_sets.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "engine_case.h"
#include "filter/many_radii.h"

namespace psf {
namespace {

using filter::engine::instruction_sets;
using filter::engine::InstructionSetLimit;
using tests::EngineCase;

// Contributions that cancel each other except for a rest, which in double depends on the order of
// the sum.
EngineCase noisy_case(std::size_t count, unsigned terms, float r) {
  EngineCase c(count, terms + 1, terms % 2 == 0 ? 0.3 : 0);
  const std::vector<Rgb> small = tests::random_records(count, 3, 0, c.cameras).contribution;
  for (std::size_t j = 0; j < count; ++j) {
    // In double a sum of 1e13 still holds a thousandth.
    const auto one_in = [j](std::size_t n, float other) {
      return j % n == 0 ? 1e13f : j % n == n / 2 ? -1e13f : other;
    };
    c.set.contribution[j] = {one_in(4, small[j].x), one_in(16, small[j].y), small[j].z};
  }
  c.parameters.weights = tests::terms_of(terms);
  c.radius.assign(count, r);
  return c;
}

std::vector<EngineCase> cases() {
  std::vector<EngineCase> all;
  for (const std::size_t count : {1u, 2u, 15u, 17u, 63u, 65u, 255u, 257u, 4097u}) {
    for (const unsigned terms : {0u, 7u, 135u, 255u}) {
      for (const float r : {0.08f, 0.5f}) all.push_back(noisy_case(count, terms, r));
    }
  }
  for (unsigned bits = 0; bits < 256; ++bits) all.push_back(noisy_case(600, bits, 0.4f));
  EngineCase repeated = noisy_case(3000, 7, 0.2f);
  repeated.parameters.iterations = 3;
  repeated.parameters.demodulate = true;
  repeated.parameters.sources = 3;
  all.push_back(repeated);
  for (const unsigned terms : {0u, 7u, 255u}) {
    for (const float r : {0.08f, 0.5f}) {
      EngineCase fit = noisy_case(3000, terms, r);
      fit.parameters.fit = filter::BallFit::linear;
      all.push_back(fit);
      EngineCase spread = noisy_case(3000, terms, r);
      spread.parameters.fireflies = {filter::FireflyRule::Kind::spread};
      all.push_back(spread);
    }
  }
  // Balls with whole nodes in their middle, whose last parent has single sources too.
  for (const float r : {0.15f, 0.2f, 0.25f, 0.3f}) {
    EngineCase fit = noisy_case(20'000, 0, r);
    fit.parameters.fit = filter::BallFit::linear;
    all.push_back(fit);
  }
  EngineCase disk = noisy_case(3000, 1, 0.2f);
  disk.parameters.estimator = filter::Estimator::disk;
  all.push_back(disk);
  return all;
}

TEST_CASE("Every instruction set gives the same bytes") {
  const std::vector<std::string> sets = instruction_sets();
  REQUIRE_FALSE(sets.empty());
  for (const EngineCase& c : cases()) {
    const filter::Estimates best = c.filtered(filter::EngineKind::flann);
    for (const std::string& set : sets) {
      const InstructionSetLimit limit(set);
      INFO(set << ", " << c.set.size() << " records");
      CHECK(tests::difference(best, c.filtered(filter::EngineKind::flann)) == "");
    }
  }
}

TEST_CASE("Every instruction set gives the same bytes for many radii") {
  std::vector<filter::Radius> radii;
  for (int k = 0; k < 20; ++k) {
    radii.push_back({0.02 * std::pow(1.2, k), filter::RadiusBasis::distance, 0.3});
  }
  struct Keep : filter::Receiver {
    void begin(std::span<const std::uint32_t> queries, std::size_t grain) override {
      parts.assign((queries.size() + grain - 1) / grain, {});
    }
    void take(std::size_t part, std::size_t, std::size_t, std::span<const Rgb> c_bar) override {
      parts[part].assign(c_bar.begin(), c_bar.end());
    }
    void end() override {
      for (const auto& part : parts) values.insert(values.end(), part.begin(), part.end());
    }
    std::vector<std::vector<Rgb>> parts;
    std::vector<Rgb> values;
  };
  const auto all = [&](const EngineCase& c) {
    filter::Parameters parameters = c.parameters;
    parameters.count_refusals = false;
    Keep keep;
    static_cast<void>(
        filter::estimate_many(c.set.view(), {0, 2, 1.5, c.cameras}, parameters, radii, keep));
    return keep.values;
  };
  for (const unsigned terms : {0u, 7u, 16u, 255u}) {
    const EngineCase c = noisy_case(3000, terms, 0.2f);
    const std::vector<Rgb> best = all(c);
    for (const std::string& set : instruction_sets()) {
      const InstructionSetLimit limit(set);
      INFO(set << ", terms " << terms);
      const std::vector<Rgb> values = all(c);
      REQUIRE(values.size() == best.size());
      CHECK(std::memcmp(values.data(), best.data(), best.size() * sizeof(Rgb)) == 0);
    }
  }
}

TEST_CASE("Any number of threads gives the same bytes") {
  for (const unsigned terms : {0u, 7u, 135u, 255u}) {
    const EngineCase c = noisy_case(20'000, terms, 0.1f);
    const auto with_threads = [&](std::size_t threads) {
      const core::ThreadLimit limit(threads);
      return c.filtered(filter::EngineKind::flann);
    };
    const filter::Estimates one = with_threads(1);
    for (const std::size_t threads : {2u, 3u, 7u}) {
      INFO("terms " << terms << ", threads " << threads);
      CHECK(tests::difference(one, with_threads(threads)) == "");
    }
  }
}

TEST_CASE("The kernel uses the instruction set that it is held to, else the best") {
  for (const std::string& set : instruction_sets()) {
    {
      const InstructionSetLimit limit(set);
      CHECK(filter::engine::instruction_set() == set);
    }
    CHECK(filter::engine::instruction_set() == instruction_sets().front());
  }
}

TEST_CASE("There is no instruction set but those that are listed") {
  CHECK_THROWS_AS(InstructionSetLimit("abacus"), Error);
  const std::vector<std::string> sets = instruction_sets();
  const InstructionSetLimit limit(sets.back());
  CHECK(instruction_sets() == sets);
}

}  // namespace
}  // namespace psf
