# Samplers, camera and the loop over passes.
find_package(nlohmann_json CONFIG REQUIRED)
target_sources(psf_render PRIVATE
  camera.cpp halton.cpp recorder.cpp render.cpp render_settings.cpp sampler.cpp shade_rate.cpp
  sobol.cpp sobol_numbers.cpp)
target_link_libraries(psf_render PRIVATE nlohmann_json::nlohmann_json)
