// Integrators by name.
#include "render/integrator.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/error.h"
#include "render/integrators.h"

namespace psf::render {

const std::vector<std::string>& integrator_names() {
  static const std::vector<std::string> names{"path", "direct", "ao"};
  return names;
}

std::unique_ptr<Integrator> make_integrator(const Scene& scene,
                                            const IntegratorSettings& settings) {
  if (settings.split < 1 || settings.max_depth < 1 || !(settings.ao_distance > 0)) {
    throw Error(ErrorCode::usage, "split, max depth and AO distance must be positive");
  }
  if (settings.name == "path" || settings.name == "direct") {
    return make_path_integrator(scene, settings);
  }
  if (settings.name == "ao") return make_ao_integrator(scene, settings);
  throw Error(ErrorCode::usage, fmt::format("no integrator '{}': use one of {}", settings.name,
                                            fmt::join(integrator_names(), ", ")));
}

}  // namespace psf::render
