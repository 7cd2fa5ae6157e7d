// psf-bench render: rays of the renderer a second, against the same rays in bare calls of Embree.
#include "render/loop/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "bench/benches.h"
#include "bench/rows.h"
#include "bench/turns.h"
#include "cli.h"
#include "core/error.h"
#include "core/json_text.h"
#include "core/parallel.h"
#include "option_values.h"
#include "render/accel/replay.h"
#include "render/camera/camera.h"
#include "render/job/option_text.h"
#include "render/light/transport.h"
#include "render/scene/load.h"
#include "version.h"

namespace psf::bench {
namespace {

struct RenderOptions {
  tools::CommonOptions common;
  std::string scene;
  std::string size = "256x256";
  std::size_t passes = 8;
  std::size_t repeat = 5;
  bool check = false;
};

constexpr Target kAtLeast{Target::Kind::at_least, 0.7};
constexpr std::size_t kMostRays = std::size_t{1} << 24;   // 704 MiB
constexpr std::size_t kLeastRays = std::size_t{1} << 20;  // of a measurement of camera rays
constexpr std::size_t kGrain = 4096;                      // rays
constexpr std::uint32_t kTile = 4;                        // pixels a side

// A scene that is ready, and how it is rendered.
struct Setup {
  render::Scene scene;
  render::RenderSettings settings;
  std::unique_ptr<render::Integrator> integrator;

  explicit Setup(const RenderOptions& options) {
    render::SceneOverrides overrides;
    if (!render::parse_size(options.size, overrides.size)) {
      throw Error(ErrorCode::usage, "`--size`: expected WxH in pixels, 1 to 65535 each");
    }
    scene = render::load_scene(options.scene, overrides);
    settings.passes = options.passes;
    settings.cameras = {0};
    settings.quiet = true;
    settings.validate(scene);
    integrator = render::make_integrator(scene, settings.integrator);
  }
  [[nodiscard]] const render::Accel& accel() const {
    return integrator->light_transport()->accel();
  }
  [[nodiscard]] render::RenderResult render() const {
    return render::render(scene, *integrator, settings, nullptr);
  }
};

void check_count(std::uint64_t rays, const std::string& scene) {
  if (rays <= kMostRays) return;
  throw Error(ErrorCode::limit, fmt::format("{}: {} rays or more are too many to keep, the most is "
                                            "{}; give fewer --passes or a smaller --size",
                                            scene, rays, kMostRays));
}

// All rays of a render, in the order of one thread.
std::vector<render::RecordedRay> recorded(const Setup& setup, const std::string& name) {
  const core::ThreadLimit one(1);
  const render::Camera& camera = setup.scene.cameras.at(0);
  check_count(setup.settings.passes * camera.width * camera.height, name);
  const std::uint64_t rays = setup.render().rays;
  check_count(rays, name);
  std::vector<render::RecordedRay> log;
  log.reserve(rays);
  setup.accel().record(&log);
  static_cast<void>(setup.render());
  setup.accel().record(nullptr);
  return log;
}

// A ray through the middle of each pixel, by tiles of 4 x 4 pixels, so that 8 or 16 in a row are
// neighbours.
std::vector<render::RecordedRay> camera_rays(const render::Camera& camera) {
  const render::CameraRays view(camera);
  std::vector<render::RecordedRay> rays;
  for (std::uint32_t top = 0; top + kTile <= camera.height; top += kTile) {
    for (std::uint32_t left = 0; left + kTile <= camera.width; left += kTile) {
      for (std::uint32_t k = 0; k < kTile * kTile; ++k) {
        const Vec2 pixel(static_cast<float>(left + k % kTile) + 0.5f,
                         static_cast<float>(top + k / kTile) + 0.5f);
        const render::Ray ray = view.ray(pixel, Vec2(0.5f, 0.5f));
        rays.push_back(
            {ray.origin, 0, ray.direction, render::RayCaster::kEndless, 0, false, false});
      }
    }
  }
  return rays;
}

// The processor time that a call takes on all threads: unlike real time it is that of the work alone
// where the machine has other work as well.
template <class Call>
double cpu_seconds_of(const Call& call) {
  const std::clock_t start = std::clock();
  call();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// Calls replay(part) for parts of the rays, on all threads. Returns how many met something.
template <class Replay>
std::uint64_t replay_parts(std::span<const render::RecordedRay> rays, const Replay& replay) {
  std::vector<std::uint64_t> met(core::range_count(rays.size(), kGrain));
  core::parallel_for(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    met[begin / kGrain] = replay(rays.subspan(begin, end - begin));
  });
  return std::accumulate(met.begin(), met.end(), std::uint64_t{0});
}

std::string ray_speeds(const Turns& turns, std::size_t rays) {
  const auto speed = [&](double seconds) { return static_cast<double>(rays) / seconds / 1e6; };
  return fmt::format("{:.2f} / {:.2f} M rays/s and core, {} pairs of runs",
                     speed(spread(turns.second).median), speed(spread(turns.first).median),
                     turns.first.size());
}

// Bare calls and the render in turn: the time of the one over that of the other.
void add_rays(const Setup& setup, std::span<const render::RecordedRay> rays, std::size_t threads,
              std::size_t repeat, std::vector<Row>& rows) {
  const core::ThreadLimit limit(threads);
  const auto met = static_cast<std::uint64_t>(
      std::count_if(rays.begin(), rays.end(), [](const auto& ray) { return ray.met; }));
  const auto bare = [&] {
    const std::uint64_t now =
        replay_parts(rays, [&](auto part) { return render::replay(setup.accel(), part); });
    if (now != met) {
      throw Error(ErrorCode::comparison,
                  fmt::format("{} of the replayed rays meet something, {} did", now, met));
    }
  };
  const auto whole = [&] { static_cast<void>(setup.render()); };
  const Turns turns(
      repeat, [&] { return cpu_seconds_of(bare); }, [&] { return cpu_seconds_of(whole); });
  rows.push_back(
      {fmt::format("rays_{}", threads),
       fmt::format("rays of a render / bare Embree, {} thread{}", threads, threads == 1 ? "" : "s"),
       "x", turns.ratio(), kAtLeast, ray_speeds(turns, rays.size())});
}

void add_packets(const Setup& setup, std::size_t repeat, std::vector<Row>& rows) {
  const core::ThreadLimit one(1);
  const std::vector<render::RecordedRay> rays = camera_rays(setup.scene.cameras.at(0));
  if (rays.empty()) return;
  const std::size_t rounds = std::max<std::size_t>(1, kLeastRays / rays.size());
  const auto often = [&](const auto& replay) {
    return cpu_seconds_of([&] {
      for (std::size_t k = 0; k < rounds; ++k) static_cast<void>(replay_parts(rays, replay));
    });
  };
  const auto singly = [&] {
    return often([&](auto part) { return render::replay(setup.accel(), part); });
  };
  for (const std::size_t width : {std::size_t{8}, std::size_t{16}}) {
    const Turns turns(repeat, singly, [&] {
      return often([&](auto part) { return render::replay_packets(setup.accel(), part, width); });
    });
    rows.push_back({fmt::format("packets_{}", width),
                    fmt::format("camera rays {} at a time / one at a time, bare Embree", width),
                    "x", turns.ratio(), std::nullopt, ray_speeds(turns, rounds * rays.size())});
  }
}

void run(const RenderOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  tools::check_files({options.scene}, {options.common.json});
  const Setup setup(options);
  const std::vector<render::RecordedRay> rays = recorded(setup, options.scene);
  const auto shadows = static_cast<std::size_t>(
      std::count_if(rays.begin(), rays.end(), [](const auto& ray) { return ray.occlusion; }));
  std::vector<Row> rows;
  add_rays(setup, rays, 1, options.repeat, rows);
  if (core::thread_count() > 1) add_rays(setup, rays, core::thread_count(), options.repeat, rows);
  add_packets(setup, options.repeat, rows);
  if (!options.common.json.empty()) {
    const nlohmann::ordered_json json = {{"version", tools::kVersion}, {"scene", options.scene},
                                         {"size", options.size},       {"passes", options.passes},
                                         {"rays", rays.size()},        {"occlusion_rays", shadows},
                                         {"repeat", options.repeat},   {"rows", to_json(rows)}};
    core::write_json_file(options.common.json, json);
  }
  fmt::print("{} rays, {} of them ask only whether something is in the way\n", rays.size(),
             shadows);
  print_table(rows);
  if (options.check) require_targets(rows);
}

}  // namespace

void add_render(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* command = app.add_subcommand(
      "render", "measure rays a second of the renderer against bare calls of Embree");
  command->add_option("SCENE", options->scene, "scene file, .json, .obj, .gltf or .glb")
      ->required()
      ->type_name("FILE");
  command->add_option("--size", options->size, "size of the picture")->type_name("WxH");
  tools::add_number<std::size_t>(*command, "--passes", options->passes, 1, 1024,
                                 "passes of a run, whose rays are all kept");
  tools::add_number<std::size_t>(*command, "--repeat", options->repeat, 1, 1000,
                                 "runs of each, in turn");
  command->add_flag("--check", options->check, "exit code 1 where a target is missed");
  tools::add_common(*command, options->common);
  tools::set_example(*command, "psf-bench render room.json");
  command->callback([options] { run(*options); });
}

}  // namespace psf::bench
