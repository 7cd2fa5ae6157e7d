#include "run/missing_terms.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

namespace psf::run {

std::string switch_off_missing(const Dump& dump, std::span<filter::Parameters> sets,
                               filter::TermSet asked) {
  std::vector<std::string> channels, options;
  const auto note = [](std::vector<std::string>& list, std::string_view text) {
    if (std::find(list.begin(), list.end(), text) == list.end()) list.emplace_back(text);
  };
  for (filter::Parameters& set : sets) {
    for (const filter::ChannelNeed& need : filter::optional_channels(set)) {
      const std::size_t term = filter::term_of(need.wanted_by);
      if (term == filter::kTermCount || ((asked >> term) & 1) != 0) continue;
      if (dump.reader().head().find(need.channel)) continue;
      set.weights.switch_off(term);
      note(channels, need.channel);
      note(options, need.wanted_by);
    }
  }
  if (options.empty()) return "";
  return fmt::format("{}: has no channel {}, so {} {} off", dump.reader().path(),
                     fmt::join(channels, ", "), fmt::join(options, ", "),
                     options.size() == 1 ? "is" : "are");
}

}  // namespace psf::run
