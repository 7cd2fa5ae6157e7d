// What stands behind a psf::Dump, and what sequences share with it.
#pragma once

#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

#include "psf/dump.h"
#include "run/dump.h"
#include "run/filter_dump.h"

namespace psf {

[[nodiscard]] std::vector<Camera> cameras_of(const run::Dump& dump);

// What psf filter makes of a dump or a frame of it: `request` with these parameters.
[[nodiscard]] FilterResult filter_with(const run::Dump& dump, run::FilterRequest request,
                                       const Parameters& parameters);

struct Dump::State {
  explicit State(const std::string& path) : dump(path), cameras(cameras_of(dump)) {
    for (const formats::Channel& channel : dump.reader().head().channels) {
      channels.push_back({channel.name, std::string(formats::name_of(channel.type)),
                          channel.components, channel.encoding == formats::Encoding::octahedral});
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
