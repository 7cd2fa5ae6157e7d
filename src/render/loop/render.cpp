// The loop itself: tracing in slabs, output one slab behind.
#include "render/loop/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <future>
#include <memory>
#include <optional>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/seconds.h"
#include "formats/read/reader.h"
#include "render/loop/photon_table.h"
#include "render/loop/resume.h"
#include "render/loop/shade_rate.h"
#include "render/loop/slab.h"
#include "render/loop/vertex_table.h"
#include "render/scene/motion.h"

namespace psf::render {
namespace {

constexpr std::size_t kSlab = std::size_t{1} << 18;        // records traced before they are written
constexpr std::size_t kVertexSlab = std::size_t{1} << 16;  // the same with the vertices of paths
constexpr std::uint64_t kPhotonSlab = std::uint64_t{1} << 16;  // light paths at once

using core::Clock;
using core::seconds_since;

class Loop {
 public:
  Loop(const Scene& scene, const Integrator& integrator, const RenderSettings& settings,
       formats::Writer* writer, const FrameOf& frame)
      : integrator_(integrator),
        space_(scene.space),
        settings_(settings),
        frame_(settings.frame_range().first + frame.index),
        first_pass_(frame.index * settings.passes),
        lights_(light_sampler(settings.sampler, frame_)),
        writer_(writer),
        shade_rate_(settings.shade_rate),
        channels_(
            record_channels(settings.channels, integrator.layers(), integrator.has_volumes())),
        has_sample_(has_sample(channels_)) {
    const bool moves = anything_moves(scene);
    result_.films.reserve(settings.cameras.size());
    std::size_t largest = 0;
    for (const std::size_t index : settings.cameras) {
      const Camera& camera = scene.cameras[index];
      const Shutter& shutter = camera.shutter;
      views_.push_back({CameraRays(camera), camera.width, camera.height, paths_a_pass_,
                        moves && shutter.blurs(), moves ? shutter_time(scene, shutter.open) : 0,
                        moves ? shutter_time(scene, shutter.close) : 0});
      paths_a_pass_ += views_.back().pixels();
      largest = std::max(largest, views_.back().pixels());
      result_.films.emplace_back(camera.width, camera.height);
    }
    result_.passes = first_pass_;
    if (frame.before != nullptr) continue_from(*frame.before);
    if (settings.integrator.vertices > 0) slab_ = kVertexSlab;
    for (auto& slab : slabs_) {
      slab = std::make_unique<Slab>(std::min(slab_, largest), integrator.layers(), channels_);
    }
  }

  // Takes up what a resumed file holds.
  void resume(const formats::Head& head);
  RenderResult run();

 private:
  void continue_from(const RenderResult& before);
  void replay();
  // These return whether the pass is still wanted.
  [[nodiscard]] bool trace_pass(std::uint64_t pass);
  [[nodiscard]] bool trace_slab(std::uint64_t pass, std::uint16_t camera, std::size_t first,
                                std::size_t count);
  void trace_path(std::uint64_t pass, std::uint16_t camera, std::size_t path, Slab& slab,
                  std::size_t slot, LayerSpace& layers, Trail* trail, std::uint64_t& rays) const;
  [[nodiscard]] bool write_photons(std::uint64_t pass);
  void drop_pass(std::uint64_t pass);
  void write_vertices(Slab& slab);
  void emit(std::uint64_t pass, std::uint16_t camera, std::size_t count);
  void wait_for_output();
  [[nodiscard]] Done done_now() const;

  const Integrator& integrator_;
  const Integrator* tracer_ = nullptr;  // of the pass
  Space space_;
  const RenderSettings& settings_;
  std::uint32_t frame_;       // its number
  std::uint64_t first_pass_;  // of the frame, in the file
  SamplerSettings lights_;
  formats::Writer* writer_;
  ShadeRate shade_rate_;
  std::vector<formats::Channel> channels_;
  bool has_sample_;  // whether any channel is of CameraSample
  std::vector<View> views_;
  std::uint64_t paths_a_pass_ = 0;
  std::uint64_t paths_done_ = 0;
  std::atomic<std::uint64_t> rays_{0};
  double seconds_before_ = 0;  // time of the runs before this one
  Clock::time_point start_ = Clock::now();
  core::Progress* progress_ = nullptr;
  RenderResult result_;
  // What result_ had of this before the pass of which it got a part.
  struct Whole {
    std::uint64_t pass, non_finite;
    std::vector<film::Film> films;  // empty where no picture is wanted
  };
  std::optional<Whole> whole_;
  // Two slabs in turn: one is traced while the other is written. The future comes last, so that it
  // is waited for before anything it uses goes.
  std::array<std::unique_ptr<Slab>, 2> slabs_;
  std::size_t current_ = 0, slab_ = kSlab;  // slab_: paths of one
  std::future<void> output_;
};

void Loop::continue_from(const RenderResult& before) {
  result_.non_finite = before.non_finite;
  result_.output_seconds = before.output_seconds;
  paths_done_ = before.paths;
  rays_ = before.rays;
  seconds_before_ = before.seconds;
}

void Loop::resume(const formats::Head& head) {
  const Done done = resume_point(*writer_, head, settings_, paths_a_pass_);
  if (settings_.replay) replay();
  result_.passes = done.passes;
  result_.non_finite = done.non_finite;
  paths_done_ = done.passes * paths_a_pass_;
  rays_ = done.rays;
  seconds_before_ = done.seconds;
  start_ = Clock::now();
}

// Adds what is committed to the films as if it had just been traced.
void Loop::replay() {
  const formats::Reader reader(writer_->path());
  core::Progress progress("read back", settings_.quiet);
  Recorder& recorder = slabs_[0]->records;
  std::uint64_t path = first_pass_ * paths_a_pass_;
  // A file of one frame may have more passes than are asked for.
  std::uint64_t end = reader.records();
  if (settings_.frames) end = std::min(end, path + settings_.passes * paths_a_pass_);
  while (path < end) {
    for (std::size_t camera = 0; camera < views_.size(); ++camera) {
      const std::size_t pixels = views_[camera].pixels();
      for (std::size_t first = 0; first < pixels; first += slab_) {
        const std::size_t count = std::min(slab_, pixels - first);
        core::throw_if_interrupted("nothing was added to the file");
        recorder.load(reader, path, count);
        (void)recorder.add_to(result_.films[camera], count, settings_.shade_rate);
        path += count;
        progress.advance(path, end);
      }
    }
  }
  progress.finish();
}

RenderResult Loop::run() {
  core::Progress progress("render", settings_.quiet);
  progress_ = &progress;
  const std::uint64_t total = settings_.total_passes();
  while (result_.passes < first_pass_ + settings_.passes) {
    if (!trace_pass(result_.passes)) {
      drop_pass(result_.passes);
      break;
    }
    ++result_.passes;
    result_.out_of_time = seconds_since(start_) >= settings_.time_limit;
    if (core::interrupted() || result_.out_of_time) break;
  }
  wait_for_output();
  progress.finish();
  result_.interrupted = core::interrupted() && result_.passes < total;
  const bool ends = first_pass_ + settings_.passes == total || result_.out_of_time;
  if (writer_ != nullptr && ends && !result_.interrupted) writer_->close();
  result_.paths = paths_done_;
  result_.rays = rays_;
  result_.seconds = seconds_before_ + seconds_since(start_);
  return std::move(result_);
}

// What the file has of it is cut off where the writer ends.
void Loop::drop_pass(std::uint64_t pass) {
  wait_for_output();
  paths_done_ = pass * paths_a_pass_;
  if (!whole_ || whole_->pass != pass) return;
  result_.non_finite = whole_->non_finite;
  if (!whole_->films.empty()) result_.films = std::move(whole_->films);
}

bool Loop::trace_pass(std::uint64_t pass) {
  std::uint64_t rays = 0;
  const auto made = integrator_.for_pass(lights_, pass - first_pass_, rays);
  rays_ += rays;
  tracer_ = made != nullptr ? made.get() : &integrator_;
  if (core::overdue()) return false;
  const bool photons = writer_ != nullptr && settings_.integrator.photons > 0;
  if (photons && !write_photons(pass)) return false;
  for (std::size_t camera = 0; camera < views_.size(); ++camera) {
    const std::size_t pixels = views_[camera].pixels();
    for (std::size_t first = 0; first < pixels; first += slab_) {
      const std::size_t count = std::min(slab_, pixels - first);
      if (!trace_slab(pass, static_cast<std::uint16_t>(camera), first, count)) return false;
      emit(pass, static_cast<std::uint16_t>(camera), count);
    }
  }
  return true;
}

bool Loop::trace_slab(std::uint64_t pass, std::uint16_t camera, std::size_t first,
                      std::size_t count) {
  // In steps that keep every thread busy for a while, so that progress moves within a slab.
  const std::size_t step = std::max<std::size_t>(64, 32 * core::thread_count()) * kGrain;
  Slab& slab = *slabs_[current_];
  std::atomic<bool> dropped{false};
  for (std::size_t begin = 0; begin < count; begin += step) {
    const std::size_t size = std::min(step, count - begin);
    core::parallel_for(size, kGrain, [&](std::size_t from, std::size_t to) {
      std::uint64_t rays = 0;
      LayerSpace layers(integrator_.layers().size());
      Trail trail(settings_.integrator.vertices);
      Trail* const wanted =
          writer_ != nullptr && settings_.integrator.vertices > 0 ? &trail : nullptr;
      for (std::size_t i = begin + from; i < begin + to; ++i) {
        trace_path(pass, camera, first + i, slab, i, layers, wanted, rays);
        // Behind each path, since a walk in it may have ended for this.
        if (core::overdue()) dropped = true;
        if (dropped) break;
      }
      rays_ += rays;
    });
    if (dropped) return false;
    paths_done_ += size;
    if (settings_.on_progress) {
      settings_.on_progress(paths_done_, settings_.total_passes() * paths_a_pass_);
    }
    const double rate =
        static_cast<double>(rays_) / std::max(1e-9, seconds_before_ + seconds_since(start_));
    progress_->advance(
        paths_done_, settings_.total_passes() * paths_a_pass_,
        fmt::format("{:.2f} M rays/s{}", rate / 1e6, core::interrupted() ? ", ending" : ""));
  }
  return true;
}

void Loop::trace_path(std::uint64_t pass, std::uint16_t camera, std::size_t path, Slab& slab,
                      std::size_t slot, LayerSpace& layers, Trail* trail,
                      std::uint64_t& rays) const {
  const View& view = views_[camera];
  const bool global = settings_.sampler.enumeration == Enumeration::global;
  const std::uint64_t in_pass = view.first + path;
  // The pass among those of all frames from 0 on.
  const std::uint64_t point = settings_.frame_range().first * settings_.passes + pass;
  Sampler sampler(settings_.sampler, global ? 0 : static_cast<std::uint32_t>(in_pass),
                  global ? point * paths_a_pass_ + in_pass : point);
  const Vec2 u = sampler.next_2d();
  std::uint32_t x = static_cast<std::uint32_t>(path % view.width);
  std::uint32_t y = static_cast<std::uint32_t>(path / view.width);
  Vec2 position(static_cast<float>(x) + u.x, static_cast<float>(y) + u.y);
  if (global) {
    // In double, where the products are exact: rounding must not move a point across pixels.
    const double plane_x = double{u.x} * view.width;
    const double plane_y = double{u.y} * view.height;
    x = static_cast<std::uint32_t>(plane_x);
    y = static_cast<std::uint32_t>(plane_y);
    position = Vec2(static_cast<float>(plane_x), static_cast<float>(plane_y));
  }
  const Vec2 lens = view.rays.has_lens() ? sampler.next_2d() : Vec2(0, 0);
  const float time = view.blurs ? sampler.next_1d() : 0;
  const float moment = view.opens + time * (view.closes - view.opens);
  const bool shade = shade_rate_.shaded(x, y, point);
  const LayerSums& sums = layers.cleared();
  if (trail != nullptr) trail->clear();
  PathRecord record =
      tracer_->trace(view.rays.ray(position, lens, moment), sampler, shade, rays, {sums, trail});
  // Without a vertex it is not shaded either way; the flag says that it counts.
  if (!record.has_vertex && settings_.shade_rate > 1) record.shaded = shade;
  slab.records.set(slot, camera, y * view.width + x, in_world(record, space_), sums);
  if (has_sample_) {
    const Vec2 on_lens = view.rays.has_lens() ? concentric_disk(lens) : Vec2(0, 0);
    slab.records.set_sample(
        slot, {{in_pixel(position.x, x), in_pixel(position.y, y)}, on_lens, time, frame_});
  }
  if (trail == nullptr) return;
  add_vertices(trail->vertices(), static_cast<std::uint32_t>(in_pass), space_,
               slab.vertices[slot / kGrain]);
}

// The photons of a pass, which may be more than fit into memory at once.
bool Loop::write_photons(std::uint64_t pass) {
  const std::uint64_t paths = settings_.integrator.photons;
  const std::size_t table = settings_.integrator.vertices > 0 ? 2 : 1;
  for (std::uint64_t first = 0; first < paths; first += kPhotonSlab) {
    std::uint64_t rays = 0;
    const std::vector<PhotonRow> rows =
        trace_photon_rows(*integrator_.light_transport(), space_, lights_, pass - first_pass_,
                          paths, {first, std::min(kPhotonSlab, paths - first)}, rays);
    rays_ += rays;
    if (core::overdue()) return false;
    wait_for_output();
    append_rows<PhotonRow>(*writer_, table, rows, photon_columns());
  }
  return true;
}

void Loop::write_vertices(Slab& slab) {
  if (settings_.integrator.vertices == 0) return;
  for (std::vector<VertexRow>& rows : slab.vertices) {
    append_rows<VertexRow>(*writer_, 1, rows, vertex_columns());
    rows.clear();
  }
}

void Loop::emit(std::uint64_t pass, std::uint16_t camera, std::size_t count) {
  wait_for_output();
  Slab& slab = *slabs_[current_];
  current_ ^= 1;
  const bool ends_pass = paths_done_ == (pass + 1) * paths_a_pass_;
  const bool begins_pass = paths_done_ - count == pass * paths_a_pass_ && !ends_pass;
  auto work = [this, &slab, pass, camera, count, begins_pass, ends_pass,
               done = done_now()]() mutable {
    if (begins_pass) {
      whole_ = {pass, result_.non_finite, {}};
      if (settings_.replay) whole_->films = result_.films;
    }
    result_.non_finite += slab.records.add_to(result_.films[camera], count, settings_.shade_rate);
    if (writer_ == nullptr) return;
    writer_->append(count, slab.records.columns(channels_));
    write_vertices(slab);
    if (!ends_pass) return;
    done.non_finite = result_.non_finite;
    const std::string state = resume_state(done, settings_);
    writer_->commit(std::as_bytes(std::span(state)));
  };
  if (core::thread_count() > 1) {
    output_ = std::async(std::launch::async, std::move(work));
  } else {
    const auto start = Clock::now();
    work();
    result_.output_seconds += seconds_since(start);
  }
}

void Loop::wait_for_output() {
  if (!output_.valid()) return;
  const auto start = Clock::now();
  output_.get();
  result_.output_seconds += seconds_since(start);
}

// The state after the paths traced so far; the caller sets the number of non-finite paths.
Done Loop::done_now() const {
  return {paths_done_ / paths_a_pass_, rays_, 0, seconds_before_ + seconds_since(start_)};
}

}  // namespace

RenderResult render(const Scene& scene, const Integrator& integrator,
                    const RenderSettings& settings, formats::Writer* writer, const FrameOf& frame) {
  settings.validate(scene);
  RenderSettings complete = settings;
  complete.cameras = chosen_cameras(scene, settings);
  Loop loop(scene, integrator, complete, writer, frame);
  // A file that this run began ends where its next frame begins.
  const std::uint64_t begun = frame.before == nullptr ? 0 : frame.index * settings.passes;
  if (writer != nullptr && writer->passes() > begun) {
    loop.resume(frame.head != nullptr ? *frame.head : make_head(scene, integrator, settings));
  }
  return loop.run();
}

}  // namespace psf::render
