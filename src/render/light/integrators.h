// The integrators behind make_integrator().
#pragma once

#include <memory>

#include "render/light/integrator.h"

namespace psf::render {

// Makes `path` or `direct`, whichever settings.name says.
[[nodiscard]] std::unique_ptr<Integrator> make_path_integrator(const Scene& scene,
                                                               const IntegratorSettings& settings);
[[nodiscard]] std::unique_ptr<Integrator> make_vpl_integrator(const Scene& scene,
                                                              const IntegratorSettings& settings);
[[nodiscard]] std::unique_ptr<Integrator> make_photon_integrator(
    const Scene& scene, const IntegratorSettings& settings);
[[nodiscard]] std::unique_ptr<Integrator> make_ao_integrator(const Scene& scene,
                                                             const IntegratorSettings& settings);

}  // namespace psf::render
