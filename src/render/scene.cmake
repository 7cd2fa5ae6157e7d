# Scene description and scene files.
find_package(fmt CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(TinyGLTF CONFIG REQUIRED)
find_package(tinyobjloader CONFIG REQUIRED)

target_sources(psf_render PRIVATE
  gltf_accessor.cpp gltf_material.cpp gltf_node.cpp json_cursor.cpp json_material.cpp json_shape.cpp json_transform.cpp load.cpp load_gltf.cpp load_hash.cpp
  load_json.cpp load_obj.cpp load_obj_check.cpp load_overrides.cpp load_validate.cpp shapes.cpp texture.cpp)
target_link_libraries(psf_render
  PRIVATE fmt::fmt nlohmann_json::nlohmann_json OpenImageIO::OpenImageIO TinyGLTF::TinyGLTF tinyobjloader::tinyobjloader)
