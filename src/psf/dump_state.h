// What stands behind a psf::Dump.
#pragma once

#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

#include "psf/dump.h"
#include "run/dump.h"

namespace psf {

struct Dump::State {
  explicit State(const std::string& path) : dump(path) {
    for (const formats::Channel& channel : dump.reader().head().channels) {
      channels.push_back({channel.name, std::string(formats::name_of(channel.type)),
                          channel.components, channel.encoding == formats::Encoding::octahedral});
    }
    for (const formats::CameraInfo& camera : dump.metadata().cameras) {
      cameras.push_back({camera.name, camera.width, camera.height, camera.angle_per_pixel});
    }
  }

  [[nodiscard]] std::size_t channel(std::string_view name) const {
    return dump.reader().require(name, "the caller");
  }

  // The dump with a vertex as options have it. Throws Error{usage} for a text that is no rule, and
  // what run::Dump::at() throws.
  [[nodiscard]] run::Dump at(const std::string& vertex) const {
    return dump.at(run::vertex_rule_of(vertex));
  }

  run::Dump dump;
  mutable std::shared_mutex mutex;  // refresh() changes what the others read
  std::vector<Channel> channels;
  std::vector<Camera> cameras;
};

}  // namespace psf
