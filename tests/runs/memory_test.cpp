// What a run may take: the plan that keeps a limit, the refusal that says what would.
#include "run/memory.h"

#include <numeric>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "filter_dump_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

constexpr std::uint64_t kMany = 20000;  // records a pass: enough to count beside the program

class Planned {
 public:
  explicit Planned(const std::vector<std::size_t>& passes) : passes_(passes.size()) {
    const std::size_t all = std::accumulate(passes.begin(), passes.end(), std::size_t{0});
    const RecordSet set = random_records(all, 31, 0, kOne);
    DumpOptions options{kOne, passes, {}};
    options.chunk_capacity = 4096;
    write_dump(folder_ / "a.pvb", set, options);
    dump_.emplace(folder_ / "a.pvb");
  }
  static constexpr std::uint64_t kBytesAPixel =
      run::CameraPictures::kBytesOfSums + run::CameraPictures::kBytesToWrite;
  // Without gloss, whose two channels and their columns take 3 times the stored records to 3.12
  // times where the next block is read ahead.
  [[nodiscard]] run::MemoryEstimate plan(const std::string& block,
                                         std::optional<std::uint64_t> limit = {},
                                         std::optional<float> gloss = {}) const {
    filter::Parameters parameters;
    parameters.weights.gloss = gloss;
    filter::set_parameter(parameters, "block", block);
    return run::plan_memory(*dump_, dump_->select(parameters, true),
                            {parameters, 0, passes_, limit, kBytesAPixel});
  }
  // What the refusal says behind the name of the file.
  [[nodiscard]] std::string refusal(const std::string& block, std::uint64_t limit) const {
    try {
      static_cast<void>(plan(block, limit));
      return "none";
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::limit);
      return std::string(error.what()).substr(dump_->reader().path().size() + 2);
    }
  }
  [[nodiscard]] const run::Dump& dump() const { return *dump_; }

  // The block that a refusal names; it fits.
  [[nodiscard]] std::string suggested(const std::string& block, std::uint64_t most) const {
    const std::string text = refusal(block, most);
    INFO(text);
    const std::string before = "; `block ", after = "` would fit";
    const std::size_t begin = text.find(before) + before.size(), end = text.find(after);
    REQUIRE(end != std::string::npos);
    CHECK(text.starts_with("`block " + block + "` takes up to "));
    const std::string fits = text.substr(begin, end - begin);
    CHECK(plan(fits, most).total() <= most);
    return fits;
  }
  // Without reading ahead.
  [[nodiscard]] std::uint64_t alone(const std::string& block) const {
    const core::ThreadLimit one(2);
    return plan(block, plan(block).total() - 1).total();
  }

 private:
  std::size_t passes_;
  TempFolder folder_;
  std::optional<run::Dump> dump_;
};

TEST_CASE("A plan counts the longest block, twice where the next one is read ahead") {
  const Planned planned(std::vector<std::size_t>(5, kMany));
  // flags 1, six vectors, distance, pixel and visibility 4 each, camera 2
  constexpr std::uint64_t kRecord = 1 + 6 * 12 + 3 * 4 + 2;
  for (const std::size_t threads : {1u, 2u}) {
    const core::ThreadLimit limit(threads);
    const auto check = [&](const std::string& block, std::uint64_t longest, bool several) {
      INFO(block << " " << threads);
      const run::MemoryEstimate plan = planned.plan(block);
      CHECK(plan.block == longest * kRecord);
      CHECK(plan.stored == longest * planned.dump().reader().head().stride());
      CHECK(plan.blocks == (several && threads > 1 ? 2 : 1));
      CHECK(plan.blocks * plan.block + plan.filter <= 3 * plan.stored);
      const run::MemoryEstimate glossy = planned.plan(block, {}, 0.8f);
      CHECK(glossy.block == longest * (kRecord + 16));  // direction 12, roughness 4
      CHECK(100 * (glossy.blocks * glossy.block + glossy.filter) <= 312 * glossy.stored);
    };
    check("1pass", kMany, true);
    check("2passes", 2 * kMany, true);
    check("5passes", 5 * kMany, false);
    check("all", 5 * kMany, false);
    check("2^13", 8192, true);
    check("2^16", 65536, true);
    check("2^40", 5 * kMany, false);
  }
}

TEST_CASE("A limit first costs reading ahead, then the run, and the block it names fits") {
  const core::ThreadLimit limit(2);
  const Planned planned(std::vector<std::size_t>(5, kMany));
  for (const std::string block : {"2passes", "2^15"}) {
    const std::uint64_t both = planned.plan(block).total();
    CHECK(planned.plan(block, both).blocks == 2);
    const run::MemoryEstimate alone = planned.plan(block, both - 1);
    CHECK(alone.blocks == 1);
    CHECK(planned.plan(block, alone.total()).blocks == 1);
    CHECK(planned.refusal(block, alone.total() - 1) != "none");
  }
  const std::uint64_t all = planned.plan("all").total();
  CHECK(planned.suggested("all", all - 1) == "4passes");
  CHECK(planned.suggested("5passes", planned.alone("2passes")) == "2passes");
  CHECK(planned.suggested("4passes", planned.alone("1pass")) == "1pass");
  CHECK(planned.suggested("2^20", planned.alone("2^15")) == "2^15");
  CHECK(planned.refusal("1pass", 1000).find("no block would fit") != std::string::npos);
}

TEST_CASE("Where not even a pass fits, a part of one is what is named") {
  const core::ThreadLimit limit(2);
  const Planned planned({300000});
  const std::uint64_t most = planned.alone("2^13");
  CHECK(planned.suggested("all", most) == "2^13");
  CHECK(planned.suggested("1pass", most) == "2^13");
  CHECK(planned.suggested("7^7", most) == "7^4");
}

TEST_CASE("A run that keeps a limit gives the same pictures; one that cannot does no work") {
  const core::ThreadLimit limit(4);
  const TempFolder folder;
  const RecordSet set = random_records(2000, 32, 0.1, kTwo);
  write_dump(folder / "a.pvb", set, {kTwo, {500, 500, 500, 500}, {}});
  FilterRequest run = default_run("2^8");
  const run::FilterResult free = run::filter_dump(run::Dump(folder / "a.pvb"), run);
  CHECK(free.memory.blocks == 2);
  run.max_memory = free.memory.total() - 1;
  const run::FilterResult bound = run::filter_dump(run::Dump(folder / "a.pvb"), run);
  CHECK(bound.memory.blocks == 1);
  CHECK(same(images(bound.pictures), images(free.pictures)));
  run.max_memory = 1;
  run.on_progress = [](std::uint64_t, std::uint64_t) { FAIL("works"); };
  CHECK_THROWS_AS(run::filter_dump(run::Dump(folder / "a.pvb"), run), Error);
}

}  // namespace
}  // namespace psf
