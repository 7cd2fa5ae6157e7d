#include "filter/inputs.h"

#include <cmath>
#include <string>

#include "core/error.h"
#include "filter/channels.h"
#include "filter/weights.h"

namespace psf::filter {

void require_channels(const Records& records, const Parameters& parameters) {
  if (records.size() == 0) return;
  for (const ChannelNeed& need : optional_channels(parameters)) {
    if (has_channel(records, need.channel)) continue;
    throw Error(ErrorCode::bad_input, "the records have no channel " + std::string(need.channel) +
                                          ", which " + std::string(need.wanted_by) + " needs");
  }
}

WeightTerms terms_in_use(const Records& records, const WeightTerms& terms) {
  WeightTerms in_use = terms;
  if (!terms.gloss) return in_use;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if ((records.flags[i] & kHasVertex) != 0 && !std::isinf(lobe_width(records.roughness[i]))) {
      return in_use;
    }
  }
  in_use.gloss.reset();
  return in_use;
}

std::vector<float> areas(const Records& records, const Roles& roles, const Block& block) {
  if (block.cameras.size() > 1) {
    throw Error(ErrorCode::usage,
                "`estimator disk` counts a surface once for every camera that sees it: "
                "it needs a dump of one camera");
  }
  std::vector<float> area(records.size());
  for (const std::uint32_t j : roles.sources) {
    area[j] = static_cast<float>(surface_area(block.cameras[0].angle_per_pixel,
                                              double{records.distance[j]}, records.normal[j],
                                              records.direction[j], block.samples_per_pixel));
  }
  return area;
}

// c / rho of the sources.
std::vector<Rgb> demodulated(const Records& records, const Roles& roles) {
  std::vector<Rgb> values(records.size(), Rgb(0, 0, 0));
  for (const std::uint32_t j : roles.sources) {
    values[j] = demodulate(records.contribution[j], records.reflectance[j]);
  }
  return values;
}

}  // namespace psf::filter
