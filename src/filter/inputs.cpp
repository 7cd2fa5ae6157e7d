#include "filter/inputs.h"

#include <cmath>
#include <string>

#include "core/error.h"
#include "filter/channels.h"
#include "filter/weights.h"

namespace psf::filter {

void require_channels(const Records& records, const Parameters& parameters) {
  if (records.size() == 0) return;
  const EstimatorInfo& estimator = info(parameters.estimator);
  if (estimator.is_of_photons && records.photons.passes == 0) {
    throw Error(ErrorCode::bad_input, "the records have no photons, which `estimator " +
                                          std::string(estimator.name) +
                                          "` needs; only a dump has them");
  }
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

std::vector<Rgb> demodulated(std::span<const Rgb> contribution, const Records& records,
                             const Roles& roles) {
  std::vector<Rgb> values(records.size(), Rgb(0, 0, 0));
  for (const std::uint32_t j : roles.sources) {
    const Rgb value = demodulate(contribution[j], records.reflectance[j]);
    if (is_finite(value)) values[j] = value;  // of layers it may not be, though it is of c
  }
  return values;
}

}  // namespace psf::filter
