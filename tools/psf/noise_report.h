// The share of u in the noise of the picture without filter, as text.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "run/noise_share.h"

namespace psf::tools {

// The share as text: "12.3%", "no noise", or the reason why it is not known.
inline std::string share_text(const run::NoiseShare& noise) {
  if (noise.pixels == 0) return "not known: no pixel has two paths";
  const double share = noise.share();
  return std::isnan(share) ? "no noise" : fmt::format("{:.1f}%", 100 * share);
}

}  // namespace psf::tools
