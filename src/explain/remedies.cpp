#include "explain/remedies.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>

#include "filter/channels.h"
#include "filter/kinds.h"

namespace psf::explain {
namespace {

using filter::Term;

// Thresholds that a person would try, from the loosest to the strictest.
constexpr std::array kCosines = {0.5f, 0.7f, 0.8f, 0.9f, 0.95f, 0.98f, 0.99f, 0.995f, 0.999f};
constexpr std::array kDifferences = {1.0f, 0.5f, 0.2f, 0.1f, 0.05f, 0.02f, 0.01f, 0.005f};
constexpr std::array kLobes = {4.0f, 2.0f, 1.0f, 0.5f, 0.25f};
constexpr std::array kOn = {1.0f};

// The thresholds to try for a term: those that are stricter than its threshold in use, if any.
// Empty where the file lacks a channel of the term.
std::span<const float> ladder(const ExplainResult& e, Term term) {
  const filter::WeightTerms& on = e.request.parameters.weights;
  const filter::TermInfo& of = filter::info(term);
  for (const std::string_view channel : of.channels) {
    if (!channel.empty() && !filter::has_channel(e.vertices, channel)) return {};
  }
  if (of.threshold == nullptr) return on.on(term) ? std::span<const float>() : kOn;
  const std::optional<float>& t = on.*of.threshold;
  const bool is_cosine = of.least < 0;  // stricter is larger
  const std::span<const float> all = is_cosine             ? std::span<const float>(kCosines)
                                     : term == Term::gloss ? std::span<const float>(kLobes)
                                                           : std::span<const float>(kDifferences);
  if (!t) return all;
  const auto next = is_cosine ? std::upper_bound(all.begin(), all.end(), *t)
                              : std::upper_bound(all.begin(), all.end(), *t, std::greater<>());
  return all.subspan(static_cast<std::size_t>(next - all.begin()));
}

filter::WeightTerms only(Term term, float threshold) {
  filter::WeightTerms terms = filter::WeightTerms::none();
  const filter::TermInfo& of = filter::info(term);
  if (of.threshold != nullptr) {
    terms.*of.threshold = threshold;
  } else {
    terms.*of.is_on = true;
  }
  return terms;
}

}  // namespace

Colour PixelIf::unfiltered(std::uint32_t vertex) const {
  return e_.vertices.unfiltered.empty() ? Colour(0, 0, 0) : wide(e_.vertices.unfiltered[vertex]);
}

void PixelIf::add(const ExplainedPair& pair, Averaged& averaged) const {
  const Rgb& value = e_.value[pair.vertex];
  averaged.sum += double{pair.area} * wide(value);
  ++averaged.count;
  if (e_.request.parameters.fit == filter::BallFit::linear) {
    averaged.fitted.push_back({pair.vertex, value});
  }
}

Colour PixelIf::reflected(const ExplainedPath& path, const Averaged& averaged) const {
  const Colour alpha = wide(e_.vertices.throughput[path.vertex]);
  if (averaged.count == 0) return alpha * wide(path.c_bar);
  const double r = double{path.radius};
  const filter::Parameters& parameters = e_.request.parameters;
  const bool disk = filter::info(parameters.estimator).is_over_area &&
                    path.radius * path.radius > 0 && !in_volume(e_.vertices, path.vertex);
  Colour mean =
      averaged.sum / (disk ? std::numbers::pi * r * r : static_cast<double>(averaged.count));
  if (!averaged.fitted.empty()) {
    const std::optional<PathFit> fit =
        fit_path(e_.vertices.view(), path.vertex, path.radius, averaged.fitted);
    if (fit) mean = fit->value;
  }
  if (parameters.demodulate) mean = remodulated(mean, e_.vertices.reflectance[path.vertex]);
  return alpha * mean + averaged.given;
}

double Remedy::gain(std::uint64_t all_leaking, std::uint64_t all_others) const {
  const auto share = [](std::uint64_t part, std::uint64_t all) {
    return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
  };
  return share(leaking, all_leaking) - share(others, all_others);
}

std::vector<Remedy> find_remedies(const ExplainResult& explanation, const PixelIf& pixel_if,
                                  const std::vector<bool>& leaking) {
  const ExplainResult& e = explanation;
  std::vector<std::pair<double, Remedy>> found;
  for (std::size_t k = 0; k < filter::kTermCount; ++k) {
    const auto term = static_cast<Term>(k);
    std::optional<std::pair<double, Remedy>> best;
    for (const float threshold : ladder(e, term)) {
      const filter::KindWeights weights(e.vertices.view(), only(term, threshold));
      const auto passes = [&](const ExplainedPair& pair) {
        const ExplainedPath& path = e.paths[pair.path];
        return weights.pass(path.vertex, pair.vertex, path.radius);
      };
      Remedy remedy;
      remedy.term = k;
      if (filter::info(term).threshold != nullptr) remedy.threshold = threshold;
      std::uint64_t all[2] = {0, 0};
      for (const ExplainedPair& pair : e.pairs) {
        if (!brings_light(pair) || pair.self) continue;
        ++all[leaking[pair.vertex] ? 1 : 0];
        if (!passes(pair)) ++(leaking[pair.vertex] ? remedy.leaking : remedy.others);
      }
      const double gain = remedy.gain(all[1], all[0]);
      if (remedy.leaking + remedy.others == 0 || (best && best->first >= gain)) continue;
      best.emplace(gain, remedy);
    }
    if (!best) continue;
    const filter::KindWeights weights(e.vertices.view(),
                                      only(term, best->second.threshold.value_or(1)));
    best->second.pixel = pixel_if([&](const ExplainedPair& pair) {
      const ExplainedPath& path = e.paths[pair.path];
      return pair.refusers == 0 && weights.pass(path.vertex, pair.vertex, path.radius);
    });
    found.push_back(*best);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Remedy> remedies;
  remedies.reserve(found.size());
  for (const auto& [gain, remedy] : found) remedies.push_back(remedy);
  return remedies;
}

}  // namespace psf::explain
