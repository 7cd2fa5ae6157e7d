// The report of psf filter on a run: text for people on stdout, JSON for programs.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/text.h"
#include "filter/parameters/text.h"
#include "filter/parameters/values.h"
#include "noise_report.h"
#include "run/filter_dump.h"
#include "study/study_file.h"

namespace psf::tools {

struct FilterReport {
  std::string input, uuid;
  std::optional<run::VertexRule> vertex;  // none: that of the file
  filter::Parameters parameters;
  run::FilterResult outcome;
  std::vector<formats::CameraInfo> cameras;
  std::vector<std::string> written;  // names of the files written
  double seconds_write = 0, seconds = 0;
  run::PeakMemory peak;
  bool has_all_layers = true;         // of the light that the dump has
  std::vector<std::uint32_t> frames;  // ascending; empty: none was chosen
  run::Window window;                 // of the first frame
};

// Names and counts that are not 0, as "a 1, b 2", or `otherwise` where all are 0.
template <typename Names, typename Counts, typename Format>
std::string listed(const Names& names, const Counts& counts, const char* otherwise, Format format) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (counts[k] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", names[k], format(counts[k]));
  }
  return text.empty() ? otherwise : text;
}

inline std::string weights_text(const filter::Parameters& parameters) {
  std::string text;
  for (const auto& [name, value] : filter::describe(parameters)) {
    const auto& terms = filter::kTermNames;
    if (std::find(terms.begin(), terms.end(), name) == terms.end() || value == "off") continue;
    text += (text.empty() ? "" : ", ") + name + (value == "on" ? "" : " " + value);
  }
  return text.empty() ? "none" : text;
}

// What is said of the layers of the light; empty: there are none.
inline std::string layers_text(const FilterReport& report) {
  constexpr double kOff = 1e-4;  // rounding is far below
  std::string text;
  double beside = 0;
  for (const run::CameraPictures& picture : report.outcome.pictures) {
    text = fmt::format("{}", fmt::join(picture.light_layers(), ", "));
    beside = std::max(beside, picture.light_beside_layers());
  }
  if (text.empty()) return text;
  const bool fits = report.parameters.fit == filter::BallFit::linear;
  std::string of_the_whole(filter::info(report.parameters.estimator).of_the_whole);
  if (fits) of_the_whole += of_the_whole.empty() ? "ridge" : " and the ridge";
  if (!of_the_whole.empty()) text += fmt::format("; with the {} of all light", of_the_whole);
  if (report.outcome.not_finite_in_layers > 0) {
    text +=
        fmt::format("; {} not finite, which count as 0",
                    core::counted(report.outcome.not_finite_in_layers, "value is", "values are"));
  }
  if (report.has_all_layers && beside > kOff) {
    text += fmt::format("; they are off the picture by {:.2g}% of its light", 100 * beside);
  }
  return text;
}

// What is said of alpha; empty: the pictures have none.
inline std::string alpha_text(const FilterReport& report) {
  const auto& pictures = report.outcome.pictures;
  if (pictures.empty() || !pictures[0].has_alpha()) return "";
  std::string text = "of the channel; the background is apart";
  if (report.outcome.not_finite_coverage > 0) {
    text +=
        fmt::format("; {} not finite, which count as 1",
                    core::counted(report.outcome.not_finite_coverage, "value is", "values are"));
  }
  return text;
}

// What became of fireflies.
inline std::string fireflies_text(const FilterReport& report) {
  const filter::Statistics& s = report.outcome.statistics;
  const filter::FireflyRule& rule = report.parameters.fireflies;
  if (s.fireflies == 0) return "none";
  const std::string became = rule.spreads() ? "spread over distances of their own" : "dimmed away";
  return fmt::format("{}, {:.2g}% of the contributions; {:.2g}% of the light {}",
                     core::with_commas(s.fireflies),
                     100 * static_cast<double>(s.fireflies) / static_cast<double>(s.sources),
                     s.light > 0 ? 100 * s.light_apart / s.light : 0.0, became);
}

// What of the records and photons is in no average.
inline std::string left_out_text(const FilterReport& report) {
  const filter::Statistics& s = report.outcome.statistics;
  const std::uint64_t all =
      s.left_out + s.without_source + s.photons_left_out + report.outcome.overflows;
  if (all == 0) return "none";
  const std::string photons =
      s.photons_left_out == 0
          ? ""
          : fmt::format(", {} not finite", core::counted(s.photons_left_out, "photon", "photons"));
  return fmt::format("{}: {} not finite ({}), {} in a block without source, {} overflowed{}",
                     core::with_commas(all), core::with_commas(s.left_out),
                     listed(filter::kCheckedNames, s.non_finite, "none", core::with_commas),
                     core::with_commas(s.without_source),
                     core::with_commas(report.outcome.overflows), photons);
}

// Which frames were filtered, and what came from those around them.
inline std::string frames_text(const FilterReport& report) {
  std::string text = report.frames.size() == 1
                         ? std::to_string(report.frames[0])
                         : fmt::format("{}:{}", report.frames.front(), report.frames.back() + 1);
  if (report.window.width == 1) return text;
  for (const auto& [name, value] : run::describe(report.window)) {
    text += fmt::format(", {} {}", name, value);
  }
  const filter::WindowCounts& counts = report.outcome.window;
  if (counts.found == 0) return text + "; nothing was found in other frames";
  text += fmt::format("; {:.1f}% of the balls in other frames count",
                      100 * static_cast<double>(counts.alike) / static_cast<double>(counts.found));
  if (counts.orphans == 0) return text;
  return text + fmt::format(", the only ones of {} orphans", core::with_commas(counts.orphans));
}

inline void print_report(const FilterReport& report) {
  const filter::Statistics& s = report.outcome.statistics;
  const filter::Parameters& p = report.parameters;
  const auto line = [](const char* name, const std::string& text) {
    fmt::print("{:<10} {}\n", name, text);
  };
  fmt::print("{}\n", report.input);
  line("records", fmt::format("{} in {} and {}, {}", core::with_commas(s.records),
                              core::counted(report.outcome.passes, "pass", "passes"),
                              core::counted(report.outcome.blocks, "block", "blocks"),
                              core::counted(report.cameras.size(), "camera", "cameras")));
  if (!report.frames.empty()) line("frames", frames_text(report));
  const std::string sources = filter::info(p.estimator).is_of_photons
                                  ? core::counted(s.photons, "photon", "photons")
                                  : core::counted(s.sources, "source", "sources");
  line("averaged", fmt::format("{} from {}; {} without vertex", core::with_commas(s.queries),
                               sources, core::with_commas(s.without_vertex)));
  if (report.vertex) line("vertex", to_text(*report.vertex));
  line("radius", fmt::format("{}, delta {:.4g}, block {}", filter::to_text(p.radius),
                             p.radius.delta, filter::to_text(p.block)));
  line("weights", weights_text(p));
  if (p.fit == filter::BallFit::linear) line("fit", "linear in place and normal");
  if (!p.fireflies.keeps()) {
    line("fireflies", fireflies_text(report));
  }
  if (p.pixels == filter::PixelRule::regress) line("pixels", "regressed over those around them");
  const std::string layers = layers_text(report);
  if (!layers.empty()) line("layers", layers);
  const std::string alpha = alpha_text(report);
  if (!alpha.empty()) line("alpha", alpha);
  const std::string in_the_ball =
      p.count_refusals && s.queries > 0
          ? fmt::format("; {:.1f} in the ball",
                        static_cast<double>(s.candidates) / static_cast<double>(s.queries))
          : "";
  line("neighbors", fmt::format("mean {:.1f}, min {}, max {}{}", s.mean_neighbors(),
                                s.queries == 0 ? "0" : core::with_commas(s.min_neighbors),
                                core::with_commas(s.max_neighbors), in_the_ball));
  if (p.count_refusals) {
    const auto share = [&s](std::uint64_t refused) {
      return fmt::format("{:.1f}%",
                         100 * static_cast<double>(refused) / static_cast<double>(s.candidates));
    };
    line("refused", listed(filter::kTermNames, s.refused, "none", share));
  }
  line("orphans", s.orphans == 0 ? "none"
                                 : fmt::format("{}, {} of them matched by no source",
                                               core::with_commas(s.orphans),
                                               core::with_commas(s.orphans_unmatched)));
  line("left out", left_out_text(report));
  const run::MemoryEstimate& memory = report.outcome.memory;
  line("memory",
       fmt::format("at most {} expected, with {} of records; {} was the peak, and {} of code",
                   core::in_mebibytes(memory.total()),
                   memory.blocks == 1 ? "one block" : "two blocks",
                   core::in_mebibytes(report.peak.own),
                   core::in_mebibytes(report.peak.process - report.peak.own)));
  line("time",
       fmt::format(
           "{:.2f} s: waiting for the reader {:.2f}, index {:.2f}, filter {:.2f}, pictures {:.2f}, "
           "write {:.2f}",
           report.seconds, report.outcome.seconds_read, s.seconds_index, s.seconds_filter,
           report.outcome.seconds_film, report.seconds_write));
  line("wrote", fmt::format("{}", fmt::join(report.written, ", ")));
}

inline nlohmann::ordered_json window_json(const FilterReport& report) {
  nlohmann::ordered_json json;
  for (const auto& [name, value] : run::describe(report.window)) json[name] = value;
  json["found"] = report.outcome.window.found;
  json["alike"] = report.outcome.window.alike;
  json["orphans"] = report.outcome.window.orphans;
  return json;
}

inline nlohmann::ordered_json to_json(const FilterReport& report) {
  using Json = nlohmann::ordered_json;
  const filter::Statistics& s = report.outcome.statistics;
  const run::MemoryEstimate& memory = report.outcome.memory;
  Json parameters, refused, non_finite;
  for (const auto& [name, value] : filter::describe(report.parameters)) parameters[name] = value;
  for (std::size_t k = 0; k < filter::kTermCount; ++k)
    refused[filter::kTermNames[k]] = s.refused[k];
  for (std::size_t k = 0; k < filter::kCheckedChannels; ++k) {
    non_finite[filter::kCheckedNames[k]] = s.non_finite[k];
  }
  Json json = {{"input", report.input},
               {"uuid", report.uuid},
               {"parameters", parameters},
               {"records", s.records},
               {"passes", report.outcome.passes},
               {"blocks", report.outcome.blocks},
               {"cameras", report.cameras.size()},
               {"without_vertex", s.without_vertex},
               {"queries", s.queries},
               {"sources", s.sources},
               {"neighbors",
                {{"mean", s.mean_neighbors()},
                 {"min", s.queries == 0 ? 0 : s.min_neighbors},
                 {"max", s.max_neighbors},
                 {"total", s.accepted}}},
               {"orphans", s.orphans},
               {"orphans_unmatched", s.orphans_unmatched},
               {"left_out", s.left_out},
               {"non_finite", non_finite},
               {"without_source", s.without_source},
               {"overflows", report.outcome.overflows},
               {"memory",
                {{"estimate", memory.total()},
                 {"program", memory.program},
                 {"pictures", memory.pictures},
                 {"block", memory.block},
                 {"blocks", memory.blocks},
                 {"filter", memory.filter},
                 {"stored_block", memory.stored},
                 {"peak", report.peak.own},
                 {"peak_process", report.peak.process}}},
               {"seconds",
                {{"total", report.seconds},
                 {"read", report.outcome.seconds_read},
                 {"index", s.seconds_index},
                 {"filter", s.seconds_filter},
                 {"pictures", report.outcome.seconds_film},
                 {"write", report.seconds_write}}},
               {"files", report.written}};
  if (filter::info(report.parameters.estimator).is_of_photons) {
    json["photons"] = s.photons;
    json["photons_left_out"] = s.photons_left_out;
  }
  if (!report.parameters.fireflies.keeps()) {
    json["fireflies"] = {
        {"count", s.fireflies}, {"light", s.light}, {"light_apart", s.light_apart}};
  }
  if (report.vertex) json["vertex"] = to_text(*report.vertex);
  if (!report.frames.empty()) json["frames"] = report.frames;
  if (report.window.width > 1) json["window"] = window_json(report);
  json["layers"] = report.outcome.pictures.empty() ? std::vector<std::string>()
                                                   : report.outcome.pictures[0].light_layers();
  const bool counted = report.parameters.count_refusals;
  json["candidates"] = counted ? Json(s.candidates) : Json(nullptr);
  json["refused"] = counted ? refused : Json(nullptr);
  std::vector<run::NoiseShare> noise;
  for (const run::NoiseMoments& of : report.outcome.noise) noise.push_back(of.share());
  json["noise"] = study::describe_noise(noise, report.cameras);
  return json;
}

}  // namespace psf::tools
