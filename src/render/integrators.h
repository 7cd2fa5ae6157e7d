// The integrators behind make_integrator().
#pragma once

#include <memory>

#include "render/integrator.h"

namespace psf::render {

// `path`, and `direct` by settings.name.
[[nodiscard]] std::unique_ptr<Integrator> make_path_integrator(const Scene& scene,
                                                               const IntegratorSettings& settings);
[[nodiscard]] std::unique_ptr<Integrator> make_ao_integrator(const Scene& scene,
                                                             const IntegratorSettings& settings);

}  // namespace psf::render
