#include "study/variants.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "filter/parameters/text.h"

namespace psf::study {
namespace {

// Everything but r0 and delta.
using Key = std::pair<filter::RadiusBasis, std::vector<std::pair<std::string, std::string>>>;

Key key_of(filter::Parameters parameters) {
  const filter::RadiusBasis basis = parameters.radius.basis;
  parameters.radius.r0 = 1;
  parameters.radius.delta = 0;
  return {basis, filter::describe(parameters)};
}

}  // namespace

std::vector<VariantGroup> group_variants(std::span<const filter::Parameters> sets) {
  std::vector<VariantGroup> groups;
  std::map<Key, std::size_t> places;
  for (std::size_t row = 0; row < sets.size(); ++row) {
    const auto [place, is_new] = places.try_emplace(key_of(sets[row]), groups.size());
    if (is_new) groups.push_back({sets[row], {}, {}});
    groups[place->second].radii.push_back(sets[row].radius);
    groups[place->second].rows.push_back(row);
  }
  return groups;
}

std::vector<Traversal> split(std::span<const VariantGroup> groups,
                             const std::function<std::size_t(const VariantGroup&)>& at_once) {
  std::vector<Traversal> traversals;
  for (const VariantGroup& group : groups) {
    const std::size_t most = at_once(group), radii = group.radii.size();
    for (std::size_t first = 0; first < radii; first += most) {
      traversals.push_back({&group, first, std::min(most, radii - first)});
    }
  }
  return traversals;
}

run::ManyRequest run_of(const Traversal& traversal) {
  run::ManyRequest run;
  run.parameters = traversal.group->parameters;
  const auto begin = traversal.group->radii.begin() + static_cast<std::ptrdiff_t>(traversal.first);
  run.radii.assign(begin, begin + static_cast<std::ptrdiff_t>(traversal.count));
  return run;
}

}  // namespace psf::study
