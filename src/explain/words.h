// Words and numbers that both halves of the text and the JSON use.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>

#include "core/text.h"
#include "explain/report.h"
#include "filter/parameters/terms.h"

namespace psf::explain {

inline constexpr const char* kFateNames[] = {"averaged", "orphan", "without vertex", "left out",
                                             "overflowed"};

// By the value of `kind`; others are like surfaces.
inline constexpr const char* kKindNames[] = {"surface", "curve", "volume"};
inline std::string kind_name(std::uint8_t kind) {
  return kind < std::size(kKindNames) ? kKindNames[kind] : fmt::format("{}", kind);
}

// A term of TermRefusals.
inline std::string term_name(std::size_t term) {
  return term < filter::kTermCount ? filter::kTermNames[term] : "kind";
}

// A point as text; -0 is shown as 0.
template <typename V>
std::string point(const V& v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x + 0, v.y + 0, v.z + 0);
}

inline std::string percent(double part, double all) {
  return all == 0 ? "-" : fmt::format("{:.1f}%", 100 * part / all);
}
inline std::string percent(std::uint64_t part, std::uint64_t all) {
  return percent(static_cast<double>(part), static_cast<double>(all));
}

// The weight of a pair in times that of a mean, for the luminance.
inline double times_mean(const ExplainResult& explanation, const ExplainedPair& pair) {
  return luminance(weight_of(explanation, pair)) / explanation.paths[pair.path].scale;
}
// A firefly in a sentence.
inline std::string firefly_text(const ExplainResult& explanation, const ExplainedFirefly& firefly) {
  std::string text =
      fmt::format("path {} is one: {:.3g} times what is ordinary there; keeps {}",
                  explanation.record[firefly.vertex], double{firefly.luminance} / firefly.ordinary,
                  percent(double{firefly.kept}, 1.0));
  if (firefly.sources == 0) return text;
  return text + fmt::format(", gives the rest to {} within {:.3g}",
                            core::counted(firefly.sources, "source", "sources"), firefly.reach);
}

// Whether a colour of the path's fit would be below 0 and is 0.
inline bool is_held(const ExplainedFit& fit) {
  return fit.taken.x < 1 || fit.taken.y < 1 || fit.taken.z < 1;
}

// What of the pixel is there to be told: fits in place of means; fireflies that are dimmed; what they
// give.
inline bool fits(const ExplainResult& explanation) {
  return explanation.request.parameters.fit == filter::BallFit::linear;
}
inline bool dims(const ExplainResult& explanation) {
  return !explanation.request.parameters.fireflies.keeps();
}
inline bool spreads(const ExplainResult& explanation) {
  return explanation.request.parameters.fireflies.spreads();
}

inline bool has_vertex(const ExplainedPath& path) {
  return path.fate != PathFate::no_vertex && path.fate != PathFate::left_out;
}

inline std::pair<std::uint32_t, std::uint32_t> pixel_of(const ExplainResult& explanation,
                                                        std::uint32_t vertex) {
  const run::BlockRecords& v = explanation.vertices;
  const std::uint32_t width = explanation.widths[v.camera.empty() ? 0 : v.camera[vertex]];
  return {v.pixel[vertex] % width, v.pixel[vertex] / width};
}

// `text` with '?' for control characters, since text of a file may hold commands for a terminal.
inline std::string shown(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7F'; }, '?');
  return text;
}

// The name of a material; empty where the dump has no name for it.
inline std::string material_name(const run::Dump& dump, std::uint32_t material) {
  const auto& names = dump.metadata().materials;
  return material < names.size() ? shown(names[material]) : "";
}
// A material as text: "wall (3)", or "3" where it has no name.
inline std::string material_text(const run::Dump& dump, std::uint32_t material) {
  const std::string name = material_name(dump, material);
  return name.empty() ? fmt::format("{}", material) : fmt::format("{} ({})", name, material);
}

// The lights of some visibility bits, by name, or by the bit's number where the bit stands for
// several lights or has no name. Light l has bit l mod 32.
inline std::string lights_text(const run::Dump& dump, std::uint32_t bits) {
  std::string text;
  const auto& names = dump.metadata().lights;
  for (std::size_t bit = 0; bit < 32; ++bit) {
    if (((bits >> bit) & 1) == 0) continue;
    const bool one = bit < names.size() && bit + 32 >= names.size() && !names[bit].empty();
    text += (text.empty() ? "" : "+") + (one ? names[bit] : fmt::format("{}", bit));
  }
  return shown(text);
}

}  // namespace psf::explain
