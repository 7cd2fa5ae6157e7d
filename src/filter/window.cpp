#include "filter/window.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/seconds.h"
#include "filter/estimators/agreement.h"
#include "filter/frame_pair.h"
#include "filter/inputs.h"
#include "filter/kinds.h"
#include "filter/roles.h"

namespace psf::filter {
namespace {

constexpr std::size_t kWindowGrain = 4096;

// With fewer sources on a side their variance says too little, and the frames are kept apart.
constexpr std::uint32_t kFewestAlike = 8;

constexpr int kBrightest = 20;  // exponent of the largest luminance of the frame itself

// One run over a pair of frames: all vertices, or those of a kind.
struct PairRun {
  Taken taken;
  WeightTerms terms;
};
std::vector<PairRun> runs_of(const Records& a, const Records& b, const WeightTerms& terms) {
  if (!has_kinds_apart(a) && !has_kinds_apart(b)) return {{Taken::all, terms}};
  return {{Taken::surfaces, terms}, {Taken::volumes, terms_in_volumes(terms)}};
}

// Who takes part where `taken` and the places say so.
Roles roles_at(Records records, const Block& block, const Parameters& parameters, Taken taken,
               bool rest) {
  records.taken = taken;
  if (rest) records.position = records.rest_position;
  Statistics counted_elsewhere;
  return find_roles(records, block, parameters, counted_elsewhere);
}

int exponent_of(const Records& records) {
  float brightest = 0;
  for (std::size_t i = 0; i < records.contribution.size(); ++i) {
    const float y = std::abs(luminance(records.contribution[i]));
    if ((records.flags[i] & kHasVertex) != 0 && std::isfinite(y))
      brightest = std::max(brightest, y);
  }
  return brightest > 0 ? kBrightest - std::ilogb(brightest) : 0;
}

bool has_moved(const Records& records, std::size_t i) {
  return !(records.position[i] == records.rest_position[i]);
}

// Of each record y and y^2 of its luminance times 2^exponent, and whether it has left its place at
// rest.
std::vector<Rgb> moments_of_records(std::span<const Rgb> values, const Records& records, bool rest,
                                    int exponent) {
  std::vector<Rgb> moments;
  moments.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float y = std::ldexp(luminance(values[i]), exponent);
    moments.emplace_back(y, y * y, rest && has_moved(records, i) ? 1.0f : 0.0f);
  }
  return moments;
}

Moments luminances_of(std::uint32_t count, const Rgb& mean) {
  return {count, count * double{mean.x}, count * double{mean.y}};
}

std::vector<Rgb> black(std::size_t count) {
  return std::vector<Rgb>(count, Rgb(0, 0, 0));
}

std::span<const Rgb> contribution_of(const Records& records, std::size_t part) {
  return part == 0 ? records.contribution : records.layers[part - 1].contribution;
}

}  // namespace

void WindowTerms::validate_with(const Parameters& parameters) const {
  if (relit && !(*relit > 0)) {
    throw Error(ErrorCode::usage, "`relit`: the threshold must be > 0, or off");
  }
  if (parameters.estimator != Estimator::average) {
    throw Error(ErrorCode::usage,
                "`window`: only `estimator average` takes in other frames; leave out the window");
  }
  if (parameters.fit != BallFit::mean) {
    throw Error(ErrorCode::usage,
                "`fit`: what other frames bring is added to a mean; give `fit mean`, or leave out "
                "the window");
  }
  if (!parameters.fireflies.keeps()) {
    throw Error(ErrorCode::usage,
                "`fireflies`: what other frames bring is averaged like any other; give `fireflies "
                "keep`, or leave out the window");
  }
  if (parameters.iterations != 1) {
    throw Error(ErrorCode::usage,
                "`iterations`: what other frames bring cannot be averaged again; give 1");
  }
  if (rest && parameters.weights.plane) {
    throw Error(ErrorCode::usage,
                "`plane`: compares places with normals, and at rest there are none; give "
                "`plane off` or `positions world`");
  }
}

FrameWindow::FrameWindow(const Records& records, std::span<const float> radius, const Block& block,
                         const Parameters& parameters, const WindowTerms& terms)
    : records_(records),
      radius_(radius),
      block_(block),
      parameters_(parameters),
      terms_(terms),
      result_(estimate(records, radius, block, parameters)),
      exponent_(exponent_of(records)),
      sums_(1 + records.layers.size()),
      added_(records.size(), 0) {
  terms_.validate_with(parameters);
  if (!has_moments()) return;
  own_.resize(records.size());
  const auto keep = [this](auto queries, auto means, auto neighbors) {
    for (const std::uint32_t i : queries) own_[i] = {neighbors[i], means[0][i]};
  };
  visit_pairs(records, block, terms_.rest, Want::moments, keep);
}

void FrameWindow::visit_pairs(const Records& other, const Block& block, bool rest, Want want,
                              const UseMeans& use) const {
  for (const PairRun& run : runs_of(records_, other, parameters_.weights)) {
    Roles queries = roles_at(records_, block_, parameters_, run.taken, rest);
    std::erase_if(queries.queries, [&](std::uint32_t i) { return !is_query(result_.roles[i]); });
    const Roles sources = roles_at(other, block, parameters_, run.taken, rest);
    if (queries.queries.empty() || sources.sources.empty()) continue;
    const FramePair pair({records_, queries}, {other, sources}, radius_, run.terms, rest);
    std::vector<std::vector<Rgb>> values = values_of(other, sources, want);
    for (std::vector<Rgb>& of_one : values) of_one = pair.behind_queries(of_one);
    std::vector<std::vector<Rgb>> means(values.size(), black(records_.size()));
    std::vector<std::uint32_t> neighbors(records_.size(), 0);
    pair.average(values, parameters_.engine, means, neighbors);
    use(queries.queries, means, neighbors);
  }
}

std::vector<std::vector<Rgb>> FrameWindow::values_of(const Records& records, const Roles& roles,
                                                     Want want) const {
  std::vector<std::vector<Rgb>> values;
  for (std::size_t part = 0; part < (want == Want::all ? sums_.size() : 1); ++part) {
    const std::span<const Rgb> c = contribution_of(records, part);
    if (c.empty()) {
      values.push_back(black(records.size()));
    } else if (parameters_.demodulate) {
      values.push_back(demodulated(c, records, roles));
    } else {
      values.emplace_back(c.begin(), c.end());
    }
  }
  if (!has_moments()) return values;
  std::vector<Rgb> moments = moments_of_records(values[0], records, terms_.rest, exponent_);
  if (want == Want::moments) return {std::move(moments)};
  values.insert(values.begin(), std::move(moments));
  return values;
}

void FrameWindow::add(const Records& other, const Block& block) {
  const auto start = core::Clock::now();
  visit_pairs(
      other, block, terms_.rest, Want::all,
      [this](auto queries, auto means, auto neighbors) { take_in(queries, means, neighbors); });
  result_.statistics.seconds_filter += core::seconds_since(start);
}

bool FrameWindow::is_alike(std::uint32_t i, const Ball& other) const {
  const Ball& own = own_[i];
  if (terms_.rest) {
    // All have left their place at rest, or none has: i itself, which may be no source, too.
    const float moved = has_moved(records_, i) ? 1 : 0;
    if (other.mean.z != moved || (own.count > 0 && own.mean.z != moved)) return false;
  }
  if (!terms_.relit) return true;
  if (own.count < kFewestAlike || other.count < kFewestAlike) return false;  // as of orphans
  if (!std::isfinite(own.mean.y) || !std::isfinite(other.mean.y)) return false;
  return same_mean(luminances_of(own.count, own.mean), luminances_of(other.count, other.mean),
                   *terms_.relit);
}

void FrameWindow::take_in(std::span<const std::uint32_t> queries,
                          std::span<const std::vector<Rgb>> means,
                          std::span<const std::uint32_t> neighbors) {
  const std::size_t first = has_moments() ? 1 : 0;
  for (std::vector<Sum>& sums : sums_) sums.resize(records_.size());
  std::vector<WindowCounts> parts(core::range_count(queries.size(), kWindowGrain));
  core::parallel_for(queries.size(), kWindowGrain, [&](std::size_t begin, std::size_t end) {
    WindowCounts& counts = parts[begin / kWindowGrain];
    for (const std::uint32_t i : queries.subspan(begin, end - begin)) {
      if (neighbors[i] == 0) continue;
      ++counts.found;
      if (has_moments() && !is_alike(i, {neighbors[i], means[0][i]})) continue;
      ++counts.alike;
      added_[i] += neighbors[i];
      for (std::size_t part = 0; part < sums_.size(); ++part) {
        sums_[part][i].add(means[first + part][i], neighbors[i]);
      }
    }
  });
  for (const WindowCounts& part : parts) counts_ += part;
}

Estimates FrameWindow::finish() {
  for (std::size_t part = 0; part < sums_.size(); ++part) {
    if (sums_[part].empty()) continue;
    std::vector<Rgb>& c_bar = part == 0 ? result_.c_bar : result_.layers[part - 1];
    if (c_bar.empty()) c_bar = black(records_.size());  // a layer without light in this frame
    core::parallel_for(added_.size(), kWindowGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (added_[i] == 0) continue;
        Rgb others = sums_[part][i].over(added_[i]);
        if (parameters_.demodulate) others = remodulate(others, records_.reflectance[i]);
        Sum all;
        all.add(c_bar[i], result_.neighbors[i]);
        all.add(others, added_[i]);
        c_bar[i] = all.over(static_cast<double>(result_.neighbors[i]) + added_[i]);
      }
    });
  }
  Statistics& statistics = result_.statistics;
  statistics.accepted = statistics.max_neighbors = 0;
  statistics.min_neighbors = Statistics().min_neighbors;
  for (std::size_t i = 0; i < added_.size(); ++i) {
    if (!is_query(result_.roles[i])) continue;
    if (result_.neighbors[i] == 0 && added_[i] > 0) ++counts_.orphans;
    result_.neighbors[i] += added_[i];
    statistics.add_query(result_.neighbors[i]);
  }
  return std::move(result_);
}

}  // namespace psf::filter
