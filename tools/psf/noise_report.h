// The share of u in the noise of the picture without filter, as text and as JSON.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "formats/layout/metadata.h"
#include "run/noise_share.h"

namespace psf::tools {

// The share as text: "12.3%", "no noise", or the reason why it is not known.
inline std::string share_text(const run::NoiseShare& noise) {
  if (noise.pixels == 0) return "not known: no pixel has two paths";
  const double share = noise.share();
  return std::isnan(share) ? "no noise" : fmt::format("{:.1f}%", 100 * share);
}

// One entry per camera; the share is null where there is no noise.
inline nlohmann::ordered_json noise_json(std::span<const run::NoiseShare> noise,
                                         std::span<const formats::CameraInfo> cameras) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < noise.size(); ++k) {
    list.push_back({{"camera", cameras[k].name},
                    {"unfiltered_share", noise[k].share()},
                    {"variance", noise[k].variance()},
                    {"unfiltered", noise[k].unfiltered},
                    {"contribution", noise[k].contribution},
                    {"covariance", noise[k].covariance},
                    {"pixels", noise[k].pixels}});
  }
  return list;
}

}  // namespace psf::tools
