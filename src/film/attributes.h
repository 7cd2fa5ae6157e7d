// What a picture says of itself as attributes of its EXR: the names that psf and psf-render share.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace psf::film {

using Attributes = std::vector<std::pair<std::string, std::string>>;

// The paths of a picture.
struct PathSource {
  std::string scene, scene_hash, integrator, sampler;
  std::uint64_t seed = 0;
};

// psf:version first: the version of the program that writes the picture.
[[nodiscard]] inline Attributes attributes_of(const std::string& version,
                                              const PathSource& source) {
  return {{"psf:version", version},
          {"psf:scene", source.scene},
          {"psf:scene-hash", source.scene_hash},
          {"psf:integrator", source.integrator},
          {"psf:sampler", source.sampler},
          {"psf:seed", std::to_string(source.seed)}};
}

// What differs between the pictures of one run: the camera, and the passes [first, last).
inline void add_picture(Attributes& attributes, const std::string& camera, std::uint64_t first,
                        std::uint64_t last) {
  attributes.emplace_back("psf:camera", camera);
  attributes.emplace_back("psf:passes", fmt::format("{}:{}", first, last));
}

}  // namespace psf::film
