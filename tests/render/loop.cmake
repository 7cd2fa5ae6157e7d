target_sources(psf_test_render PRIVATE
  camera_test.cpp recorder_test.cpp render_picture_test.cpp render_program_test.cpp render_test.cpp
  sampler_statistics_test.cpp sampler_test.cpp)
target_link_libraries(psf_test_render PRIVATE psf::formats psf::film)
add_dependencies(psf_test_render psf-render)
