#include "run/missing_terms.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

namespace psf::run {

std::string switch_off_missing(const Dump& dump, std::span<filter::Parameters> sets,
                               filter::TermSet asked) {
  std::vector<std::string> channels, terms;
  const auto note = [](std::vector<std::string>& list, std::string_view text) {
    if (std::find(list.begin(), list.end(), text) == list.end()) list.emplace_back(text);
  };
  for (filter::Parameters& set : sets) {
    for (const filter::ChannelNeed& need : filter::optional_channels(set)) {
      if (!need.term || (asked & filter::bit(*need.term)) != 0) continue;
      if (dump.has(need.channel)) continue;
      set.weights.switch_off(*need.term);
      note(channels, need.channel);
      note(terms, need.wanted_by);
    }
  }
  if (terms.empty()) return "";
  const std::string what =
      dump.vertex_rule() ? fmt::format("the vertices of {} have", to_text(*dump.vertex_rule()))
                         : "has";
  return fmt::format("{}: {} no channel {}, so {} {} off", dump.reader().path(), what,
                     fmt::join(channels, ", "), fmt::join(terms, ", "),
                     terms.size() == 1 ? "is" : "are");
}

}  // namespace psf::run
