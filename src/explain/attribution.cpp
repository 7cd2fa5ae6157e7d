#include "explain/attribution.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "explain/remedies.h"
#include "filter/channels.h"
#include "filter/kinds.h"

namespace psf::explain {
namespace {

bool is_counted(const ExplainedPath& path) {
  return path.fate != PathFate::left_out && path.fate != PathFate::overflowed;
}

class Tracer {
 public:
  explicit Tracer(const ExplainResult& explanation) : e_(explanation), pixel_if_(explanation) {}

  Attribution run() {
    add_up_pixel();
    count_refusals();
    rank_sources();
    find_leak();
    group();
    result_.remedies = find_remedies(e_, pixel_if_, leaking_);
    return std::move(result_);
  }

 private:
  void add_up_pixel() {
    PixelSums& pixel = result_.pixel;
    pixel.paths =
        static_cast<std::uint64_t>(std::count_if(e_.paths.begin(), e_.paths.end(), is_counted));
    Colour own(0, 0, 0), reflected(0, 0, 0), alpha(0, 0, 0);
    std::vector<double>
        averaged;  // the part that is averaged: the rest is the same, filtered or not
    double brightest = 0;
    for (std::size_t p = 0; p < e_.paths.size(); ++p) {
      const ExplainedPath& path = e_.paths[p];
      const std::uint32_t i = path.vertex;
      const bool bare = path.fate == PathFate::no_vertex;
      if (!is_counted(path)) continue;
      Colour radiance = pixel_if_.unfiltered(i), part(0, 0, 0);
      pixel.filtered += radiance;
      pixel.of_means += radiance;
      if (!bare) {
        const Colour throughput = wide(e_.vertices.throughput[i]);
        pixel.filtered += throughput * wide(path.c_bar);
        pixel.of_means += throughput * if_mean(path);
        pixel.given += throughput * wide(path.given);
      }
      if (!path.is_input) continue;
      if (!bare) {
        const Colour alpha_i = wide(e_.vertices.throughput[i]);
        part = alpha_i * wide(e_.vertices.contribution[i]);
        averaged.push_back(luminance(part));
        radiance += part;
        reflected += part;
        alpha += alpha_i;
      }
      own += radiance;
      ++pixel.own_paths;
      if (luminance(radiance) <= brightest) continue;
      brightest = luminance(radiance);
      pixel.brightest = p;
    }
    for (Colour* sum : {&pixel.filtered, &pixel.of_means, &pixel.given}) {
      if (pixel.paths > 0) *sum /= static_cast<double>(pixel.paths);
    }
    if (pixel.own_paths == 0) return;
    const auto n = static_cast<double>(pixel.own_paths);
    pixel.own = own / n;
    if (luminance(own) > 0) pixel.brightest_share = brightest / luminance(own);
    pixel.own_error =
        standard_error(averaged, luminance(reflected)) * static_cast<double>(averaged.size()) / n;
    for (int c = 0; c < 3; ++c) {
      if (alpha[c] != 0) pixel.baseline[c] = reflected[c] / alpha[c];
    }
  }

  static double standard_error(const std::vector<double>& values, double sum) {
    if (values.size() < 2) return 0;
    const auto n = static_cast<double>(values.size());
    double squares = 0;
    for (const double value : values) squares += (value - sum / n) * (value - sum / n);
    return std::sqrt(squares / (n - 1) / n);
  }

  void count_refusals() {
    constexpr std::uint32_t kApart = filter::KindWeights::kApart;
    static_assert(kApart == 1u << filter::kTermCount);
    const bool kinds = std::any_of(e_.pairs.begin(), e_.pairs.end(),
                                   [](const auto& pair) { return (pair.refusers & kApart) != 0; });
    for (std::size_t k = 0; k < filter::kTermCount + (kinds ? 1 : 0); ++k) {
      const bool is_term = k < filter::kTermCount;
      if (is_term && !e_.request.parameters.weights.on(static_cast<filter::Term>(k))) continue;
      const std::uint32_t bit = 1u << k;
      TermRefusals of;
      of.term = k;
      for (const ExplainedPair& pair : e_.pairs) {
        if (!pair.in_ball) continue;
        of.refused += (pair.refusers & bit) != 0 ? 1u : 0u;
        of.alone += pair.refusers == bit ? 1u : 0u;
      }
      of.without =
          pixel_if_([bit](const ExplainedPair& pair) { return (pair.refusers & ~bit) == 0; });
      result_.refusals.push_back(of);
    }
    result_.candidates = static_cast<std::uint64_t>(std::count_if(
        e_.pairs.begin(), e_.pairs.end(), [](const auto& pair) { return pair.in_ball; }));
  }

  // The excess of one pair that brings light; all that is given is excess. The excesses of all pairs
  // sum to the difference.
  [[nodiscard]] Colour excess_of(const ExplainedPair& pair) const {
    const ExplainedPath& path = e_.paths[pair.path];
    const auto n = static_cast<double>(result_.pixel.paths);
    const Colour own = wide(e_.vertices.throughput[path.vertex]) * result_.pixel.baseline;
    Colour excess = share_of(e_, pair, result_.pixel.paths);
    if (!pair.averaged) return excess;
    excess -= own / (n * averaged_[pair.path]);
    if (path.fit) excess -= own * path.fit->taken * double{pair.beside} / n;
    return excess;
  }

  void rank_sources() {
    averaged_.assign(e_.paths.size(), 0);
    for (const ExplainedPair& pair : e_.pairs) averaged_[pair.path] += pair.averaged ? 1 : 0;
    std::vector<SourceShare> of_vertex(e_.record.size());
    std::vector<double> most(e_.record.size(), 0);
    for (std::size_t p = 0; p < e_.pairs.size(); ++p) {
      const ExplainedPair& pair = e_.pairs[p];
      if (!brings_light(pair) || !is_counted(e_.paths[pair.path])) continue;
      SourceShare& source = of_vertex[pair.vertex];
      const Colour excess = excess_of(pair);
      const double weight = std::abs(luminance(excess));
      if (source.paths == 0 || weight > most[pair.vertex]) {
        most[pair.vertex] = weight;
        source.pair = p;
      }
      source.vertex = pair.vertex;
      ++source.paths;
      source.share += share_of(e_, pair, result_.pixel.paths);
      source.given += given_of(e_, pair, result_.pixel.paths);
      source.excess += excess;
      result_.pixel.difference += excess;
    }
    for (const SourceShare& source : of_vertex) {
      if (source.paths > 0) result_.sources.push_back(source);
    }
    sign_ = luminance(result_.pixel.difference) < 0 ? -1 : 1;
    sort_by_excess(result_.sources);
  }

  void sort_by_excess(auto& list) const {
    std::stable_sort(list.begin(), list.end(), [this](const auto& a, const auto& b) {
      return sign_ * luminance(a.excess) > sign_ * luminance(b.excess);
    });
  }

  void find_leak() {
    const double all = sign_ * luminance(result_.pixel.difference);
    double sum = 0;
    while (result_.leak < result_.sources.size() && sum < all) {
      const double excess = sign_ * luminance(result_.sources[result_.leak].excess);
      if (!(excess > 0)) break;
      sum += excess;
      ++result_.leak;
    }
    leaking_.assign(e_.record.size(), false);
    for (std::size_t k = 0; k < result_.leak; ++k) leaking_[result_.sources[k].vertex] = true;
  }

  [[nodiscard]] filter::WeightTerms terms_that_tell_apart() const {
    filter::WeightTerms apart = e_.request.parameters.weights;
    const filter::WeightTerms defaults;
    for (std::size_t k = 0; k < filter::kTermCount; ++k) {
      const filter::TermInfo& term = filter::kTerms[k];
      const bool is_possible =
          std::all_of(term.channels.begin(), term.channels.end(), [this](std::string_view channel) {
            return channel.empty() || filter::has_channel(e_.vertices, channel);
          });
      if (std::string_view(term.apart).empty()) {
        apart.switch_off(static_cast<filter::Term>(k));
      } else if (term.threshold == nullptr) {
        apart.*term.is_on = is_possible;
      } else if (is_possible && !(apart.*term.threshold)) {
        apart.*term.threshold = (defaults.*term.threshold).value_or(kApart);
      }
    }
    return apart;
  }

  void group() {
    const filter::KindWeights weights(e_.vertices.view(), terms_that_tell_apart());
    std::map<std::uint32_t, KindShare> kinds;
    std::map<std::pair<std::uint16_t, std::uint32_t>, PixelShare> pixels;
    std::vector<bool> met(e_.record.size(), false);
    for (const ExplainedPair& pair : e_.pairs) {
      const ExplainedPath& path = e_.paths[pair.path];
      if (!brings_light(pair) || !is_counted(path)) continue;
      const std::uint32_t j = pair.vertex;
      const Colour excess = excess_of(pair);
      const std::uint16_t camera = e_.vertices.camera.empty() ? 0 : e_.vertices.camera[j];
      PixelShare& pixel = pixels[{camera, e_.vertices.pixel[j]}];
      pixel.camera = camera;
      pixel.pixel = e_.vertices.pixel[j];
      if (!met[j]) ++pixel.sources;
      met[j] = true;
      pixel.share += share_of(e_, pair, result_.pixel.paths);
      add(pixel, pair, excess);
      if (pair.self) continue;
      KindShare& kind = kinds[weights.refusers(path.vertex, j, path.radius)];
      ++kind.pairs;
      kind.leaking += leaking_[j] ? 1u : 0u;
      kind.excess += excess;
      ++(leaking_[j] ? result_.leak_pairs : result_.other_pairs);
    }
    for (auto& [terms, kind] : kinds) {
      kind.terms = terms;
      result_.kinds.push_back(kind);
    }
    for (auto& [key, pixel] : pixels) {
      const auto n = static_cast<double>(pixel.pairs);
      for (double* mean :
           {&pixel.angle, &pixel.reflectance, &pixel.lights, &pixel.material, &pixel.plane}) {
        *mean /= n;
      }
      result_.pixels.push_back(pixel);
    }
    sort_by_excess(result_.kinds);
    sort_by_excess(result_.pixels);
  }

  void add(PixelShare& pixel, const ExplainedPair& pair, const Colour& excess) const {
    const PairFeatures features = features_of(e_, pair);
    ++pixel.pairs;
    pixel.leaking += leaking_[pair.vertex] ? 1u : 0u;
    pixel.excess += excess;
    pixel.angle += features.angle.value_or(0);
    pixel.reflectance += features.reflectance.value_or(0);
    pixel.lights += features.lights.value_or(0) != 0 ? 1 : 0;
    pixel.material += features.material.value_or(false) ? 1 : 0;
    pixel.plane += features.plane.value_or(0);
  }

  const ExplainResult& e_;
  PixelIf pixel_if_;
  Attribution result_;
  double sign_ = 1;
  std::vector<double> averaged_;  // sources, by path
  std::vector<bool> leaking_;     // by vertex
};

}  // namespace

double luminance(const Colour& colour) {
  return 0.2126 * colour.x + 0.7152 * colour.y + 0.0722 * colour.z;
}

Attribution attribute(const ExplainResult& explanation) {
  return Tracer(explanation).run();
}

}  // namespace psf::explain
