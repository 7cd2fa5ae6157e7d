#include "run/many_dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/seconds.h"
#include "filter/blocks.h"
#include "filter/parameters/text.h"
#include "filter/radius.h"
#include "run/block_reader.h"
#include "run/many_adder.h"

namespace psf::run {
namespace {

using core::Clock;
using core::seconds_since;

// Pictures beside those that grow: of a last block that is not whole, and one to look at.
constexpr std::uint64_t kCopies = 2;

MemoryRequest request_of(const ManyRequest& run, std::size_t last, std::size_t radii) {
  return {run.parameters,
          run.passes.first,
          last,
          run.max_memory,
          kCopies * run.parts * ManyPictures::bytes_of_sums(radii) + ManyAdder::kBytesAPixel,
          ManyAdder::memory(radii),
          filter::kManyBytesPerRecord};
}

// With the distance, which tells how many pixels a radius is, whatever its unit.
ChannelSet channels_of(const Dump& dump, const ManyRequest& run) {
  filter::Parameters parameters = run.parameters;
  if (parameters.radius.basis == filter::RadiusBasis::world) {
    parameters.radius.basis = filter::RadiusBasis::distance;
  }
  return dump.select(parameters, false);
}

class ManyRunner {
 public:
  ManyRunner(const Dump& dump, const ManyRequest& run)
      : dump_(dump),
        run_(run),
        first_(run.passes.first),
        last_(last_pass(dump, run.passes)),
        channels_(channels_of(dump, run)),
        reader_(dump, channels_) {
    check_parts();
    outcome_.memory = plan_memory(dump_, channels_, request_of(run_, last_, run_.radii.size()));
    for (std::size_t part = 0; part < run_.parts; ++part) {
      for (const filter::CameraView& camera : dump_.cameras()) {
        outcome_.pictures.emplace_back(camera, run_.radii.size());
      }
    }
    outcome_.statistics.resize(run_.radii.size());
  }

  ManyResult run() {
    std::vector<std::uint64_t> snapshots = run_.snapshots;
    if (snapshots.empty()) snapshots.push_back(last_ - first_);
    for (const std::uint64_t n : snapshots) {
      const bool final = n == snapshots.back();
      filter_up_to(n, final);
    }
    return std::move(outcome_);
  }

 private:
  void check_parts() const {
    const filter::Blocks blocks(run_.parameters.block, dump_.pass_bounds(), first_, last_);
    if (blocks.count() >= run_.parts) return;
    throw Error(ErrorCode::usage,
                fmt::format("{}: `block {}` makes {} of {} passes, so there are no {} parts to "
                            "compare; give a smaller `block` or a longer dump",
                            dump_.reader().path(), filter::to_text(run_.parameters.block),
                            blocks.count() == 1 ? "one block" : "too few blocks", last_ - first_,
                            run_.parts));
  }

  // Whole blocks are kept from one number of passes to the next.
  void filter_up_to(std::uint64_t n, bool final) {
    const filter::Blocks blocks(run_.parameters.block, dump_.pass_bounds(), first_, first_ + n);
    outcome_.passes = n;
    outcome_.blocks = blocks.count();
    while (next_block_ < blocks.count() && blocks.is_whole(next_block_)) {
      filter_block(blocks, next_block_++);
    }
    if (next_block_ == blocks.count()) {
      if (run_.on_snapshot) run_.on_snapshot(n, outcome_);
      return;
    }
    std::optional<ManyResult> whole;
    if (!final) whole = outcome_;
    filter_block(blocks, next_block_);
    if (run_.on_snapshot) run_.on_snapshot(n, outcome_);
    if (!whole) return;
    whole->seconds = outcome_.seconds;
    outcome_ = std::move(*whole);
  }

  void filter_block(const filter::Blocks& blocks, std::uint64_t k) {
    const auto start = Clock::now();
    const filter::PathRange range = blocks[k];
    const bool ahead = outcome_.memory.blocks > 1 && k + 1 < blocks.count();
    const filter::Records records =
        reader_.read(range, ahead ? std::optional(blocks[k + 1]) : std::nullopt).view();
    const filter::Block block = describe_block(dump_, blocks, k, run_.radii.front().count);
    const std::size_t cameras = dump_.cameras().size();
    const std::span<ManyPictures> pictures =
        std::span(outcome_.pictures).subspan(k % run_.parts * cameras, cameras);
    filter::ManyAverages averages;
    adder_.start(records, pictures);
    core::undisturbed([&] {
      averages = filter::average_many(records, block, run_.parameters, run_.radii, adder_);
    });
    outcome_.overflows += adder_.overflows();
    for (std::size_t i = 0; i < records.size(); ++i) {
      const std::size_t camera = records.camera.empty() ? 0 : records.camera[i];
      pictures[camera].add_record(records, averages.roles[i], i);
    }
    for (std::size_t r = 0; r < run_.radii.size(); ++r) {
      outcome_.statistics[r] += averages.statistics[r];
    }
    set_radius(records, block, averages.roles);
    outcome_.seconds += seconds_since(start);
    if (run_.on_progress) {
      run_.on_progress(range.last - dump_.pass_bounds()[first_],
                       dump_.pass_bounds()[last_] - dump_.pass_bounds()[first_]);
    }
  }

  void set_radius(const filter::Records& records, const filter::Block& block,
                  const std::vector<filter::Role>& roles) {
    const double pixels = pixels_of_basis(records, block, roles);
    outcome_.last_radius.clear();
    for (const filter::Radius& radius : run_.radii) {
      outcome_.last_radius.push_back(filter::radius_scale(radius, block.n) * pixels);
    }
    if (outcome_.first_radius.empty()) outcome_.first_radius = outcome_.last_radius;
  }
  // Mean of f_i over the footprint of a pixel.
  [[nodiscard]] double pixels_of_basis(const filter::Records& records, const filter::Block& block,
                                       const std::vector<filter::Role>& roles) const {
    const filter::Radius& basis = run_.radii.front();
    if (basis.basis == filter::RadiusBasis::footprint) return 1;
    double sum = 0;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (!filter::is_query(roles[i])) continue;
      const std::size_t camera = records.camera.empty() ? 0 : records.camera[i];
      const double footprint = block.cameras[camera].angle_per_pixel * double{records.distance[i]};
      if (!(footprint > 0)) continue;
      sum += filter::basis_of(basis, records, block, i) / footprint;
      ++count;
    }
    return count == 0 ? 0 : sum / static_cast<double>(count);
  }

  const Dump& dump_;
  const ManyRequest& run_;
  std::size_t first_, last_;  // passes
  ChannelSet channels_;
  BlockReader reader_;
  ManyAdder adder_;
  std::uint64_t next_block_ = 0;
  ManyResult outcome_;
};

}  // namespace

ManyResult filter_many(const Dump& dump, const ManyRequest& run) {
  run.parameters.validate();
  return ManyRunner(dump, run).run();
}

std::size_t radii_at_once(const Dump& dump, const ManyRequest& run) {
  const std::size_t last = last_pass(dump, run.passes);
  const ChannelSet channels = channels_of(dump, run);
  std::size_t radii = run.radii.size();
  while (radii > 1 && !fits_memory(dump, channels, request_of(run, last, radii))) {
    radii = (radii + 1) / 2;
  }
  return radii;
}

}  // namespace psf::run
