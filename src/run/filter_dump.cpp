#include "run/filter_dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/seconds.h"
#include "film/light_layers.h"
#include "filter/estimate.h"
#include "filter/radius.h"
#include "run/block_loop.h"

namespace psf::run {
namespace {

using core::Clock;
using core::seconds_since;

class DumpFilter {
 public:
  // `copies`: of the pictures that are kept at once.
  DumpFilter(const Dump& dump, const FilterRequest& run, std::uint64_t copies)
      : dump_(dump),
        run_(run),
        copies_(copies),
        first_(run.passes.first),
        blocks_(dump, channels_of(dump, run), run.parameters.block, run.parameters.radius.count,
                run.passes.first) {
    if (run.window.others.empty()) return;
    window_.emplace(dump.pass_bounds()[first_], run.window, run.parameters,
                    [&run](const Dump& other) { return channels_of(other, run); });
  }

  // All passes up to `last`, not included.
  FilterResult run(std::size_t last) {
    set_last(last);
    if (blocks_.visit_whole(visitor_)) blocks_.visit_rest(visitor_);
    return std::move(outcome_);
  }

  // The same, for a dump that grows: may be called again with more passes.
  FilterResult run_so_far(std::size_t last) {
    set_last(last);
    if (!blocks_.visit_whole(visitor_)) return outcome_;
    FilterResult whole = outcome_;
    blocks_.visit_rest(visitor_);
    return std::exchange(outcome_, std::move(whole));
  }

 private:
  static ChannelSet channels_of(const Dump& dump, const FilterRequest& run) {
    ChannelSet channels = dump.select(run.parameters, run.layers.albedo || run.layers.normal);
    channels.layers = light_layers(dump.reader(), run.layers.light);
    const auto& rule = dump.vertex_rule();
    if (!channels.layers.empty() && rule && rule->kind != VertexRule::Kind::first_rough) {
      throw Error(ErrorCode::bad_input,
                  dump.reader().path() +
                      ": its layers of the light are those of the renderer's vertex; `layers none` "
                      "does without them");
    }
    if (!channels.layers.empty() && channels.photons) {
      throw Error(ErrorCode::bad_input,
                  dump.reader().path() +
                      ": its layers of the light are of paths, and `estimator density` takes "
                      "photons; `layers none` does without them");
    }
    if (!run.window.others.empty() && run.window.terms.rest) {
      channels.rest_position =
          dump.require("rest_position", "`positions rest`", "give `positions world`");
    }
    if (run.layers.alpha) channels.coverage = dump.find("alpha");
    if (channels.coverage) check_no_background(dump, channels.layers);
    return channels;
  }

  // A picture has one layer of a name.
  static void check_no_background(const Dump& dump, const std::vector<LightLayer>& layers) {
    for (const LightLayer& layer : layers) {
      if (layer.name != film::kBackground) continue;
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: has a layer {} of the light and the channel alpha, with which "
                              "pictures have another layer of this name; psf cat --drop alpha "
                              "leaves that out, `layers` one of them",
                              dump.reader().path(), layer.name));
    }
  }

  void make_pictures() {
    PictureLayers layers = run_.layers;
    layers.light.emplace();
    for (const LightLayer& layer : blocks_.channels().layers) layers.light->push_back(layer.name);
    layers.albedo = layers.albedo && blocks_.channels().reflectance.has_value();
    layers.normal = layers.normal && blocks_.channels().normal.has_value();
    layers.alpha = layers.alpha && blocks_.channels().coverage.has_value();
    layers.fireflies = layers.fireflies && run_.parameters.fireflies.spreads();
    for (const filter::CameraView& camera : dump_.cameras()) {
      outcome_.pictures.emplace_back(camera, layers, run_.parameters.pixels);
      if (run_.with_noise) outcome_.noise.emplace_back(camera);
    }
  }

  void set_last(std::size_t last) {
    const std::uint64_t layers = blocks_.channels().layers.size();
    const bool alpha = blocks_.channels().coverage.has_value();
    const bool spread = run_.parameters.fireflies.spreads();
    const bool regress = run_.parameters.pixels == filter::PixelRule::regress;
    const std::uint64_t planes = 3 + 3 * layers + (alpha ? 4 : 0) + (spread ? 3 : 0);
    const std::uint64_t sums = CameraPictures::kBytesOfSums +
                               layers * CameraPictures::kBytesOfSumsALayer +
                               (alpha ? CameraPictures::kBytesOfSumsOfAlpha : 0) +
                               (spread ? CameraPictures::kBytesOfFireflies : 0) +
                               (regress ? CameraPictures::kBytesOfSumsOfRegress : 0) +
                               (run_.with_noise ? NoiseMoments::kBytesAPixel : 0);
    const std::uint64_t writing = CameraPictures::kBytesToWrite +
                                  layers * CameraPictures::kBytesToWriteALayer +
                                  (alpha ? CameraPictures::kBytesToWriteOfAlpha : 0) +
                                  (regress ? PixelFeatures::bytes_to_regress(planes) : 0);
    outcome_.memory = plan_memory(dump_, blocks_.channels(),
                                  {run_.parameters, first_, last, run_.max_memory,
                                   copies_ * sums + writing, 0, 0, window_.has_value()});
    blocks_.set_last(last, outcome_.memory.blocks > 1);
    outcome_.passes = last - first_;
    outcome_.blocks = blocks_.count();
    if (outcome_.pictures.empty()) make_pictures();
  }

  void filter(const BlockLoop::Visit& visit) {
    outcome_.seconds_read = blocks_.seconds_read() + (window_ ? window_->seconds_read() : 0);
    filter::Estimates estimates;
    core::undisturbed([&] {
      filter::radii(run_.parameters.radius, visit.records, visit.block, radius_);
      estimates = window_ ? window_->estimate(visit, radius_)
                          : filter::estimate(visit.records, radius_, visit.block, run_.parameters);
    });
    if (window_) outcome_.window = window_->counts();
    outcome_.statistics += estimates.statistics;
    outcome_.not_finite_in_layers += visit.not_finite_in_layers;
    outcome_.not_finite_coverage += visit.not_finite_coverage;
    add_to_pictures(visit.paths, visit.records, estimates);
    if (run_.on_progress) {
      run_.on_progress(visit.paths.last - blocks_.all().first, blocks_.all().size());
    }
  }

  void add_to_pictures(const filter::PathRange& range, const filter::Records& records,
                       const filter::Estimates& estimates) {
    std::size_t i = 0;
    const auto add_up_to = [&](std::uint64_t path) {
      const auto start = Clock::now();
      const auto end = static_cast<std::size_t>(path - range.first);
      core::undisturbed([&] {
        outcome_.overflows += add_records(records, estimates, radius_, i, end, outcome_.pictures);
        if (run_.with_noise) add_noise(records, estimates.roles, i, end, outcome_.noise);
      });
      i = end;
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
  const FilterRequest& run_;
  std::uint64_t copies_;
  std::size_t first_;  // pass
  BlockLoop blocks_;
  BlockLoop::Visitor visitor_ = [this](const BlockLoop::Visit& visit) { filter(visit); };
  std::optional<WindowReader> window_;
  std::size_t next_snapshot_ = 0;
  std::vector<float> radius_;
  FilterResult outcome_;
};

}  // namespace

void check(const Dump& dump, const FilterRequest& run) {
  run.parameters.validate();
  check_window(dump, run.window, run.parameters);
  const std::uint64_t passes = last_pass(dump, run.passes) - run.passes.first;
  for (const std::uint64_t snapshot : run.snapshots) {
    if (snapshot >= 1 && snapshot <= passes) continue;
    throw Error(ErrorCode::usage, fmt::format("{}: no snapshot after {} of {} passes",
                                              dump.reader().path(), snapshot, passes));
  }
  if (!std::is_sorted(run.snapshots.begin(), run.snapshots.end())) {
    throw Error(ErrorCode::usage, "`snapshots`: the numbers of passes must ascend");
  }
}

FilterResult filter_dump(const Dump& dump, const FilterRequest& run) {
  check(dump, run);
  return DumpFilter(dump, run, 1).run(last_pass(dump, run.passes));
}

FilterResult follow_dump(Dump& dump, const FilterRequest& run,
                         const std::function<void(const FilterResult&)>& on_pictures,
                         const std::function<void()>& wait) {
  run.parameters.validate();
  DumpFilter runner(dump, run, 3);  // 3 sets: whole blocks, with the last block, handed out before
  FilterResult outcome;
  for (;;) {
    const std::size_t passes = dump.pass_bounds().size() - 1;
    const std::size_t last = std::min(passes, run.passes.last.value_or(passes));
    if (last > run.passes.first + outcome.passes) {
      outcome = runner.run_so_far(last);
      on_pictures(outcome);
    }
    if (dump.reader().closed() || last == run.passes.last) {
      if (outcome.passes == 0) static_cast<void>(last_pass(dump, run.passes));
      return outcome;
    }
    while (!dump.refresh()) wait();
  }
}

}  // namespace psf::run
