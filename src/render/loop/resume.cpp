#include "render/loop/resume.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/json_text.h"

namespace psf::render {
namespace {

using Json = nlohmann::json;

// The settings that shape the paths and are not in the metadata.
Json unlisted_settings(const RenderSettings& settings) {
  const IntegratorSettings& integrator = settings.integrator;
  Json state{{"shade_rate", settings.shade_rate},
             {"max_depth", integrator.max_depth},
             {"roulette_depth", integrator.roulette_depth}};
  if (std::isfinite(integrator.ao_distance)) state["ao_distance"] = integrator.ao_distance;
  if (integrator.light_sampling != LightSampling::automatic) {
    state["light_sampling"] = integrator.light_sampling == LightSampling::power ? "power" : "tree";
  }
  if (integrator.vertices > 0) state["vertices"] = integrator.vertices;
  if (integrator.photons > 0) state["photons"] = integrator.photons;
  if (integrator.name == "vpl") {
    state["vpl_paths"] = integrator.vpl_paths;
    state["vpl_set"] = integrator.vpl_set == VplSet::pass ? "pass" : "pixel";
    state["vpl_distance"] = integrator.vpl_distance;
  }
  if (integrator.name == "photon") {
    state["photon_paths"] = integrator.photon_paths;
    state["photon_radius"] = integrator.photon_radius;
    state["photon_delta"] = integrator.photon_delta;
  }
  return state;
}

[[noreturn]] void refuse(const formats::Writer& writer, const std::string& why) {
  throw Error(ErrorCode::bad_input, fmt::format("{}: cannot be continued: {}", writer.path(), why));
}

// A value as a message has it; a long one says nothing.
std::string brief(const Json& value) {
  const std::string text = value.is_null() ? "not given" : core::json_text(value);
  return text.size() <= 60 ? text : "another one";
}

// Objects are compared member by member, numbers and texts before what is too long to be told.
void check_same(const formats::Writer& writer, const Json& before, const Json& now,
                const std::string& of = "") {
  const auto check = [&](const std::string& key) {
    const Json was = before.value(key, Json()), is = now.value(key, Json());
    if (was == is) return;
    if (key == "materials" && was.is_null()) return;  // a dump from before they had names
    if (was.is_object() && is.is_object()) check_same(writer, was, is, of + key + " ");
    refuse(writer,
           fmt::format("it was rendered with {}{} {}, now it is {}; give the same options and "
                       "scene, or another name",
                       of, key, brief(was), brief(is)));
  };
  for (const bool structured : {false, true}) {
    for (const Json* side : {&now, &before}) {
      for (const auto& item : side->items()) {
        if (item.value().is_structured() == structured) check(item.key());
      }
    }
  }
}

}  // namespace

std::string resume_state(const Done& done, const RenderSettings& settings) {
  const Json state{{"next_pass", done.passes},
                   {"rays", done.rays},
                   {"non_finite", done.non_finite},
                   {"seconds", done.seconds},
                   {"settings", unlisted_settings(settings)}};
  return core::json_text(state);
}

Done resume_point(const formats::Writer& writer, const formats::Head& head,
                  const RenderSettings& settings, std::uint64_t paths_a_pass) {
  check_same(writer, Json::parse(writer.head().metadata), Json::parse(head.metadata));
  const std::span<const std::byte> bytes = writer.resume_state();
  const Json state =
      Json::parse(reinterpret_cast<const char*>(bytes.data()),
                  reinterpret_cast<const char*>(bytes.data()) + bytes.size(), nullptr, false);
  try {
    check_same(writer, state.at("settings"), unlisted_settings(settings));
    const Done done{state.at("next_pass"), state.at("rays"), state.at("non_finite"),
                    state.at("seconds")};
    if (done.passes == writer.passes() && writer.records() == done.passes * paths_a_pass) {
      return done;
    }
    refuse(writer, fmt::format("it holds {} records in {} passes where the renderer had written "
                               "{} passes of {}; render anew under another name",
                               writer.records(), writer.passes(), done.passes, paths_a_pass));
  } catch (const Json::exception&) {
    refuse(writer,
           "its last commit has no state of psf-render; it was joined, recovered with losses or "
           "written by another program");
  }
}

}  // namespace psf::render
