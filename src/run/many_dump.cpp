#include "run/many_dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/seconds.h"
#include "filter/blocks.h"
#include "filter/parameters/values.h"
#include "filter/radius.h"
#include "run/block_loop.h"
#include "run/many_adder.h"

namespace psf::run {
namespace {

using core::Clock;
using core::seconds_since;

// Pictures beside those that grow: of a last block that is not whole, and one to look at.
constexpr std::uint64_t kCopies = 2;

MemoryRequest request_of(const ManyRequest& run, std::size_t last, std::size_t radii) {
  return {
      run.parameters,
      run.passes.first,
      last,
      run.max_memory,
      kCopies * run.parts * ManyPictures::bytes_of_sums(radii, run.parameters.pixels) +
          ManyAdder::kBytesAPixel +
          (run.parameters.pixels == filter::PixelRule::keep ? 0
                                                            : PixelFeatures::bytes_to_regress(3)),
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

class ManyFilter {
 public:
  ManyFilter(const Dump& dump, const ManyRequest& run)
      : dump_(dump),
        run_(run),
        first_(run.passes.first),
        last_(last_pass(dump, run.passes)),
        blocks_(dump, channels_of(dump, run), run.parameters.block, run.radii.front().count,
                run.passes.first) {
    check_parts();
    outcome_.memory =
        plan_memory(dump_, blocks_.channels(), request_of(run_, last_, run_.radii.size()));
    for (std::size_t part = 0; part < run_.parts; ++part) {
      for (const filter::CameraView& camera : dump_.cameras()) {
        outcome_.pictures.emplace_back(camera, run_.radii.size(), run_.parameters.pixels);
      }
    }
    outcome_.statistics.resize(run_.radii.size());
  }

  ManyResult run() {
    std::vector<std::uint64_t> n = run_.n;
    if (n.empty()) n.push_back(last_ - first_);
    for (const std::uint64_t passes : n) filter_up_to(passes, passes == n.back());
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
  void filter_up_to(std::uint64_t n, bool is_last) {
    blocks_.set_last(first_ + n, outcome_.memory.blocks > 1);
    outcome_.passes = n;
    outcome_.blocks = blocks_.count();
    const auto start = Clock::now();
    std::optional<ManyResult> whole;
    if (blocks_.visit_whole(visitor_)) {
      if (!is_last) whole = outcome_;
      blocks_.visit_rest(visitor_);
    }
    outcome_.seconds += seconds_since(start);
    if (run_.on_pictures) run_.on_pictures(n, outcome_);
    if (!whole) return;
    whole->seconds = outcome_.seconds;
    outcome_ = std::move(*whole);
  }

  void filter(const BlockLoop::Visit& visit) {
    const filter::Records& records = visit.records;
    const std::size_t cameras = dump_.cameras().size();
    const std::span<ManyPictures> pictures =
        std::span(outcome_.pictures).subspan(visit.number % run_.parts * cameras, cameras);
    filter::ManyEstimates averages;
    adder_.start(records, pictures);
    core::undisturbed([&] {
      averages =
          filter::estimate_many(visit.records, visit.block, run_.parameters, run_.radii, adder_);
    });
    outcome_.overflows += adder_.overflows();
    for (std::size_t i = 0; i < records.size(); ++i) {
      const std::size_t camera = records.camera.empty() ? 0 : records.camera[i];
      pictures[camera].add_record(records, averages.roles[i], i);
    }
    for (std::size_t r = 0; r < run_.radii.size(); ++r) {
      outcome_.statistics[r] += averages.statistics[r];
    }
    set_radius(records, visit.block, averages.roles);
    if (run_.on_progress) {
      run_.on_progress(visit.paths.last - dump_.pass_bounds()[first_],
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
  BlockLoop blocks_;
  BlockLoop::Visitor visitor_ = [this](const BlockLoop::Visit& visit) { filter(visit); };
  ManyAdder adder_;
  ManyResult outcome_;
};

}  // namespace

ManyResult filter_many(const Dump& dump, const ManyRequest& run) {
  run.parameters.validate();
  return ManyFilter(dump, run).run();
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
