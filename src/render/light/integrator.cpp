// Integrators by name.
#include "render/light/integrator.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "render/light/integrators.h"
#include "render/scene/motion.h"
#include "render/scene/volumes.h"

namespace psf::render {

const std::vector<std::string>& integrator_names() {
  static const std::vector<std::string> names{"path", "direct", "vpl", "photon", "ao"};
  return names;
}

PathRecord in_world(PathRecord record, const Space& space) {
  if (space.is_world()) return record;
  if (record.has_vertex) {
    record.position = Vec3(space.world(record.position));
    record.rest = Vec3(space.world(record.rest));
  }
  record.distance = space.world_length(record.distance);
  record.hit_distance = space.world_length(record.hit_distance);
  return record;
}

std::unique_ptr<const Integrator> Integrator::for_pass(const SamplerSettings&, std::uint64_t,
                                                       std::uint64_t&) const {
  return nullptr;
}

namespace {

void refuse_volumes(const Scene& scene, const IntegratorSettings& settings) {
  const bool from_lights = settings.name == "vpl" || settings.name == "photon";
  if (!from_lights && settings.photons == 0 && settings.vertices == 0) return;
  const std::string volume = volume_in_use(scene);
  if (volume.empty()) return;
  const auto refuse = [&](const std::string& what, const char* remedy) {
    throw Error(ErrorCode::usage, fmt::format("{} between the surfaces, and the scene has {}; {}",
                                              what, volume, remedy));
  };
  if (from_lights) {
    refuse(fmt::format("the integrator {} knows no media", settings.name),
           "use the integrator path, or take that out of the scene");
  }
  if (settings.photons > 0) {
    refuse("`photons`: paths from the lights know no media",
           "leave `photons` out, or take that out of the scene");
  }
  refuse("`vertices`: the table cannot tell of media",
         "leave `vertices` out, or take that out of the scene");
}

}  // namespace

std::unique_ptr<Integrator> make_integrator(const Scene& scene, const IntegratorSettings& given) {
  IntegratorSettings settings = given;
  settings.ao_distance = scene.space.local_length(double{given.ao_distance});
  settings.vpl_distance = scene.space.local_length(double{given.vpl_distance});
  settings.photon_radius = scene.space.local_length(double{given.photon_radius});
  if (settings.split < 1 || settings.max_depth < 1 || !(settings.ao_distance > 0)) {
    throw Error(ErrorCode::usage, "split, max depth and AO distance must be positive");
  }
  if (settings.vpl_paths < 1 || settings.photon_paths < 1 || !(settings.vpl_distance >= 0) ||
      !(settings.photon_radius >= 0) ||
      !(settings.photon_delta >= 0 && settings.photon_delta < 1)) {
    throw Error(ErrorCode::usage,
                "light paths must be at least 1, VPL distance and photon radius at least 0, photon "
                "delta from 0 to below 1");
  }
  if (settings.name == "ao" && settings.layers != LayerKind::none) {
    throw Error(ErrorCode::usage, "`layers`: the integrator ao has no light to divide");
  }
  const bool chains = settings.name == "path" || settings.name == "direct";
  if (settings.vertices > 0 && (!chains || settings.split > 1)) {
    throw Error(
        ErrorCode::usage,
        "`vertices`: only the paths of the integrators path and direct, without `split`, are "
        "chains of vertices");
  }
  if (shapes_move(scene) &&
      (settings.name == "vpl" || settings.name == "photon" || settings.photons > 0)) {
    throw Error(ErrorCode::usage,
                "paths from the lights (`vpl`, `photon`, `photons`) know no motion while the "
                "shutter is open; use `path`, or the shutter 0:0");
  }
  refuse_volumes(scene, settings);
  if (settings.photons > 0 && settings.name == "ao") {
    throw Error(ErrorCode::usage, "`photons`: the integrator ao has no lights");
  }
  if (chains) {
    return make_path_integrator(scene, settings);
  }
  if (settings.name == "vpl") return make_vpl_integrator(scene, settings);
  if (settings.name == "photon") return make_photon_integrator(scene, settings);
  if (settings.name == "ao") return make_ao_integrator(scene, settings);
  throw Error(ErrorCode::usage, fmt::format("no integrator '{}': use one of {}", settings.name,
                                            fmt::join(integrator_names(), ", ")));
}

}  // namespace psf::render
