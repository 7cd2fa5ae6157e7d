#include "run/missing_terms.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace psf::run {
namespace {

[[noreturn]] void refuse(filter::Term term, std::string_view estimator) {
  const std::string_view name = filter::info(term).name;
  throw Error(ErrorCode::usage,
              fmt::format("`{0}`: photons of `estimator {1}` have nothing that it compares; leave "
                          "`{0}` out",
                          name, estimator));
}

}  // namespace

std::string switch_off_missing(const Dump& dump, std::span<filter::Parameters> sets,
                               filter::TermSet asked) {
  std::vector<std::string> channels, terms, of_photons;
  const auto note = [](std::vector<std::string>& list, std::string_view text) {
    if (std::find(list.begin(), list.end(), text) == list.end()) list.emplace_back(text);
  };
  for (filter::Parameters& set : sets) {
    for (std::size_t k = 0; k < filter::kTermCount; ++k) {
      const auto term = static_cast<filter::Term>(k);
      const filter::EstimatorInfo& estimator = filter::info(set.estimator);
      if (!set.weights.on(term) || (estimator.terms & filter::bit(term)) != 0) continue;
      if ((asked & filter::bit(term)) != 0) refuse(term, estimator.name);
      set.weights.switch_off(term);
      note(of_photons, fmt::format("`{}`", filter::info(term).name));
    }
    for (const filter::ChannelNeed& need : filter::optional_channels(set)) {
      if (!need.term || (asked & filter::bit(*need.term)) != 0) continue;
      if (dump.has(need.channel)) continue;
      set.weights.switch_off(*need.term);
      note(channels, need.channel);
      note(terms, need.wanted_by);
    }
  }
  std::string text;
  if (!terms.empty()) {
    const std::string who =
        dump.vertex_rule() ? fmt::format("the vertices of {} have", to_text(*dump.vertex_rule()))
                           : "has";
    text = fmt::format("{} no channel {}, so {} {} off", who, fmt::join(channels, ", "),
                       fmt::join(terms, ", "), terms.size() == 1 ? "is" : "are");
  }
  if (!of_photons.empty()) {
    text += fmt::format("{}photons cannot tell {}, which {} off", text.empty() ? "" : "; ",
                        fmt::join(of_photons, ", "), of_photons.size() == 1 ? "is" : "are");
  }
  return text.empty() ? text : fmt::format("{}: {}", dump.reader().path(), text);
}

}  // namespace psf::run
