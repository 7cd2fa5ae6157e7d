// What the pictures of a filter run say of themselves.
#pragma once

#include <filesystem>
#include <string>

#include "film/attributes.h"
#include "filter/parameters/text.h"
#include "run/dump.h"
#include "run/filter_dump.h"
#include "run/window.h"

namespace psf::run {

// The dump, every parameter and the window, without what differs between the pictures of a run.
[[nodiscard]] inline film::Attributes attributes_of(const std::string& version, const Dump& dump,
                                                    const FilterRequest& run) {
  const formats::Metadata& m = dump.metadata();
  film::Attributes attributes =
      film::attributes_of(version, {m.scene, m.scene_hash, m.integrator, m.sampler, m.seed});
  const std::string file = std::filesystem::path(dump.reader().path()).filename().string();
  attributes.insert(attributes.begin() + 1,
                    {{"psf:dump", file}, {"psf:dump-uuid", dump.reader().uuid()}});
  if (dump.vertex_rule()) attributes.emplace_back("psf:vertex", to_text(*dump.vertex_rule()));
  for (const auto& [name, text] : filter::describe(run.parameters)) {
    attributes.emplace_back("psf:" + name, text);
  }
  for (const auto& [name, text] : describe(run.window)) {
    attributes.emplace_back("psf:" + name, text);
  }
  return attributes;
}

}  // namespace psf::run
