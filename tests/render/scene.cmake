# Scene description and scene files.
target_sources(psf_test_render PRIVATE
  load_gltf_test.cpp load_json_error_test.cpp load_json_test.cpp load_obj_test.cpp load_overrides_test.cpp load_samples_test.cpp
  texture_test.cpp)
find_package(nlohmann_json CONFIG REQUIRED)
target_link_libraries(psf_test_render PRIVATE nlohmann_json::nlohmann_json)
