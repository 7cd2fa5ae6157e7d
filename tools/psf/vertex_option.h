// The option --vertex, which every verb that filters dumps takes, and dumps that are opened with it.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "run/dump.h"

namespace psf::tools {

inline void add_vertex(CLI::App& command, std::string& vertex) {
  command
      .add_option("--vertex", vertex,
                  "average at another vertex of the same paths, where the dump has all "
                  "(psf-render --vertices): the renderer's first rough one, that with K vertices "
                  "before it, the first of at least roughness T, or at least D away")
      ->type_name("first-rough|depth:K|roughness:T|distance:D");
}

// `vertex`: as written; empty: the vertex of the file.
// `frame`: of a sequence, whose cameras are taken; none: those of the file.
[[nodiscard]] inline run::Dump open_dump(const std::string& path, const std::string& vertex,
                                         std::optional<std::uint32_t> frame = {}) {
  return run::Dump(path, run::vertex_rule_of(vertex), frame);
}

}  // namespace psf::tools
