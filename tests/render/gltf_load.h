// Documents of glTF as scenes, errors and notes.
#pragma once

#include <cstddef>
#include <string>

#include "catch.h"
#include "gltf_document.h"
#include "load_support.h"

namespace psf::render {

inline Scene load(const Document& d, const SceneOverrides& overrides = {}) {
  const TempFolder folder;
  return load_scene(folder.write("s.gltf", d.gltf()), overrides);
}

inline Failure failure_of(const Document& d) {
  const TempFolder folder;
  Failure failure = load_failure(folder.write("s.gltf", d.gltf()));
  CHECK(!contains(failure.message, "\n"));
  CHECK(failure.message.size() < 300);
  return failure;
}

// How many notes have `part`.
inline std::size_t notes(const Scene& scene, const std::string& part) {
  std::size_t count = 0;
  for (const std::string& warning : scene.warnings) count += contains(warning, part);
  return count;
}

}  // namespace psf::render
