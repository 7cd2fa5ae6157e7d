#include "study/filter_dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "core/error.h"
#include "filter/average.h"
#include "filter/radius.h"

namespace psf::study {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::size_t last_pass(const Dump& dump, const PassSelection& selection) {
  const std::size_t passes = dump.pass_bounds().size() - 1;
  const std::size_t last = selection.last.value_or(passes);
  if (selection.first >= last || last > passes) {
    throw Error(ErrorCode::usage, fmt::format("{}: has passes 0:{}, {}:{} is no part of them",
                                              dump.reader().path(), passes, selection.first, last));
  }
  return last;
}

void check_snapshots(const Dump& dump, const std::vector<std::uint64_t>& snapshots,
                     std::uint64_t passes) {
  for (const std::uint64_t snapshot : snapshots) {
    if (snapshot >= 1 && snapshot <= passes) continue;
    throw Error(ErrorCode::usage, fmt::format("{}: no snapshot after {} of {} passes",
                                              dump.reader().path(), snapshot, passes));
  }
  if (!std::is_sorted(snapshots.begin(), snapshots.end())) {
    throw Error(ErrorCode::usage, "--snapshots: the numbers of passes must ascend");
  }
}

class Runner {
 public:
  Runner(const Dump& dump, const FilterRun& run)
      : dump_(dump),
        run_(run),
        first_(run.passes.first),
        last_(last_pass(dump, run.passes)),
        blocks_(run.parameters.block, dump.pass_bounds(), first_, last_),
        channels_(dump.select(run.parameters, true)) {
    check_snapshots(dump, run.snapshots, last_ - first_);
    for (const filter::CameraView& camera : dump.cameras()) {
      outcome_.pictures.emplace_back(camera, channels_.reflectance.has_value(),
                                     channels_.normal.has_value());
    }
  }

  FilterOutcome run() {
    for (std::uint64_t k = 0; k < blocks_.count(); ++k) {
      const filter::PathRange range = blocks_[k];
      const auto read_start = Clock::now();
      dump_.read(range, channels_, records_);
      outcome_.seconds_read += seconds_since(read_start);

      const filter::Records records = records_.view();
      const filter::Block block = describe(k, range);
      filter::radii(run_.parameters.radius, records, block, radius_);
      const filter::Average average = filter::average(records, radius_, block, run_.parameters);
      outcome_.statistics += average.statistics;

      add_to_pictures(range, records, average);
      if (run_.on_progress)
        run_.on_progress(range.last - blocks_.all().first, blocks_.all().size());
    }
    outcome_.passes = last_ - first_;
    outcome_.blocks = blocks_.count();
    return std::move(outcome_);
  }

 private:
  [[nodiscard]] filter::Block describe(std::uint64_t k, const filter::PathRange& range) const {
    const auto pixels = static_cast<double>(dump_.pixels());
    const double samples = static_cast<double>(range.last - blocks_.all().first) / pixels;
    const double within = static_cast<double>(range.size()) / pixels;
    const bool by_samples = run_.parameters.radius.count == filter::RadiusCount::samples;
    // Paths enumerated by pixel fill whole pixels even where the block is less than a pass.
    const bool global = dump_.metadata().enumeration == "global";
    return {range.first, by_samples ? samples : static_cast<double>(k + 1),
            global ? within : std::max(1.0, within), dump_.cameras()};
  }

  void add_to_pictures(const filter::PathRange& range, const filter::Records& records,
                       const filter::Average& average) {
    std::size_t i = 0;
    const auto add_up_to = [&](std::uint64_t path) {
      const auto start = Clock::now();
      for (; range.first + i < path; ++i) {
        CameraPictures& pictures =
            outcome_.pictures[records.camera.empty() ? 0 : records.camera[i]];
        if (!pictures.add(records, average, radius_, i)) ++outcome_.overflows;
      }
      outcome_.seconds_film += seconds_since(start);
    };
    while (next_snapshot_ < run_.snapshots.size()) {
      const std::uint64_t passes = run_.snapshots[next_snapshot_];
      const std::uint64_t end = dump_.pass_bounds()[first_ + passes];
      if (end > range.last) break;
      add_up_to(end);
      if (run_.on_snapshot) run_.on_snapshot(passes, outcome_.pictures);
      ++next_snapshot_;
    }
    add_up_to(range.last);
  }

  const Dump& dump_;
  const FilterRun& run_;
  std::size_t first_, last_;  // passes
  filter::Blocks blocks_;
  ChannelSet channels_;
  std::size_t next_snapshot_ = 0;
  BlockRecords records_;
  std::vector<float> radius_;
  FilterOutcome outcome_;
};

}  // namespace

FilterOutcome filter_dump(const Dump& dump, const FilterRun& run) {
  run.parameters.validate();
  return Runner(dump, run).run();
}

}  // namespace psf::study
