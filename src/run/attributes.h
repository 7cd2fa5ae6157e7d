// What the pictures of a filter run say of themselves.
#pragma once

#include <filesystem>
#include <string>

#include "film/attributes.h"
#include "filter/parameters/text.h"
#include "run/dump.h"

namespace psf::run {

// The dump and every parameter, without what differs between the pictures of a run.
[[nodiscard]] inline film::Attributes attributes_of(const std::string& version, const Dump& dump,
                                                    const filter::Parameters& parameters) {
  const formats::Metadata& m = dump.metadata();
  film::Attributes attributes =
      film::attributes_of(version, {m.scene, m.scene_hash, m.integrator, m.sampler, m.seed});
  const std::string file = std::filesystem::path(dump.reader().path()).filename().string();
  attributes.insert(attributes.begin() + 1,
                    {{"psf:dump", file}, {"psf:dump-uuid", dump.reader().uuid()}});
  if (dump.vertex_rule()) attributes.emplace_back("psf:vertex", to_text(*dump.vertex_rule()));
  for (const auto& [name, text] : filter::describe(parameters)) {
    attributes.emplace_back("psf:" + name, text);
  }
  return attributes;
}

}  // namespace psf::run
