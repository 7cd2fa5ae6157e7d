#include "study/converge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/seconds.h"
#include "filter/blocks.h"
#include "run/filter_dump.h"
#include "study/variants.h"

namespace psf::study {
namespace {

using core::Clock;
using core::seconds_since;

constexpr std::uint64_t kMostPictures = std::uint64_t{1} << 30;  // bytes, where no limit is given

void check_replicates(const std::vector<run::Dump>& dumps, std::uint64_t passes) {
  const run::Dump& first = dumps.front();
  for (std::size_t r = 0; r < dumps.size(); ++r) {
    const run::Dump& dump = dumps[r];
    const std::string& path = dump.reader().path();
    if (dump.pass_bounds().size() - 1 < passes) {
      throw Error(ErrorCode::usage,
                  fmt::format("{}: has {} passes, {} are asked for; give `passes`", path,
                              dump.pass_bounds().size() - 1, passes));
    }
    if (dump.metadata().cameras != first.metadata().cameras ||
        dump.metadata().scene_hash != first.metadata().scene_hash) {
      throw Error(
          ErrorCode::bad_input,
          fmt::format("{}: is of another scene or camera than {}; give dumps that differ in "
                      "the seed alone",
                      path, first.reader().path()));
    }
    for (std::size_t s = 0; s < r; ++s) {
      if (dumps[s].metadata().seed != dump.metadata().seed) continue;
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: has the seed {} of {}, so they are not independent; render it "
                              "with another, which the metadata name as \"seed\"",
                              path, dump.metadata().seed, dumps[s].reader().path()));
    }
  }
}

// Pictures of one set at one n, by replicate, and what is averaged of them.
struct Cell {
  std::vector<std::vector<Rgb>> pictures;
  metrics::Metrics sums;
  double neighbors = 0, radius = 0;

  void add(const metrics::Reference& reference, std::vector<Rgb> picture) {
    const metrics::Metrics metrics = reference.measure(picture);
    for (std::size_t m = 0; m < metrics::kMetricCount; ++m) {
      const double before = pictures.empty() ? 0 : sums.values[m];
      sums.values[m] = before + metrics.values[m];
    }
    sums.non_finite = std::max(sums.non_finite, metrics.non_finite);
    sums.pixels = metrics.pixels;
    pictures.push_back(std::move(picture));
  }
};

class Study {
 public:
  Study(std::span<const std::string> paths, const metrics::Reference& reference,
        std::span<const Rgb> reference_picture, const ConvergeRequest& convergence)
      : reference_(reference), picture_(reference_picture), c_(convergence) {
    for (const std::string& path : paths) dumps_.emplace_back(path, c_.vertex);
    check_replicates(dumps_, c_.n.back());
    series_.resize(c_.sets.size() + 1);
    for (std::size_t k = 0; k < c_.sets.size(); ++k) series_[k + 1].parameters = c_.sets[k];
    for (ConvergeSeries& one : series_) one.points.resize(c_.n.size());
  }

  std::vector<ConvergeSeries> run() {
    const std::vector<VariantGroup> groups = group_variants(c_.sets);
    const std::vector<Traversal> traversals =
        split(groups, [this](const VariantGroup& group) { return sets_at_once(group); });
    runs_ = traversals.size() * dumps_.size() + (c_.with_times ? c_.sets.size() : 0);
    for (const Traversal& traversal : traversals) traverse(traversal);
    for (std::size_t k = 0; c_.with_times && k < c_.sets.size(); ++k) measure_time(k);
    return std::move(series_);
  }

 private:
  [[nodiscard]] run::ManyRequest run_of(const Traversal& traversal) const {
    run::ManyRequest run = study::run_of(traversal);
    run.passes.last = static_cast<std::size_t>(c_.n.back());
    run.n = c_.n;
    run.max_memory = c_.max_memory;
    return run;
  }

  [[nodiscard]] std::size_t sets_at_once(const VariantGroup& group) const {
    const std::uint64_t pictures =
        dumps_.size() * c_.n.size() * picture_.size() * sizeof(Rgb);  // bytes per set
    const auto fitting = static_cast<std::size_t>(c_.max_memory.value_or(kMostPictures) / pictures);
    const std::size_t filtering =
        run::radii_at_once(dumps_.front(), run_of({&group, 0, group.radii.size()}));
    return std::clamp<std::size_t>(fitting, 1, filtering);
  }

  void traverse(const Traversal& traversal) {
    const std::size_t count = traversal.count;
    const bool with_unfiltered = done_ == 0;
    const std::size_t rows = count + (with_unfiltered ? 1 : 0);
    std::vector<std::vector<Cell>> cells(rows, std::vector<Cell>(c_.n.size()));
    for (std::size_t r = 0; r < dumps_.size(); ++r) {
      run::ManyRequest run = run_of(traversal);
      std::size_t place = 0;
      run.on_pictures = [&](std::uint64_t n, const run::ManyResult& outcome) {
        const run::ManyPictures& pictures = outcome.pictures[c_.camera];
        for (std::size_t k = 0; k < rows; ++k) {
          Cell& cell = cells[k][place];
          const bool filtered = k < count;
          std::vector<Rgb> picture = filtered ? pictures.filtered(k) : pictures.unfiltered();
          if (r == 0 && c_.on_picture) {
            c_.on_picture(filtered ? std::optional(traversal.row(k)) : std::nullopt, n, picture);
          }
          cell.add(reference_, std::move(picture));
          if (!filtered) continue;
          cell.neighbors += outcome.statistics[k].mean_neighbors();
          cell.radius = outcome.last_radius[k];
        }
        ++place;
      };
      run.on_progress = [this](std::uint64_t done, std::uint64_t total) { progress(done, total); };
      static_cast<void>(run::filter_many(dumps_[r], run));
      ++done_;
    }
    for (std::size_t k = 0; k < rows; ++k) {
      ConvergeSeries& series = series_[k < count ? traversal.row(k) + 1 : 0];
      for (std::size_t t = 0; t < c_.n.size(); ++t) {
        finish(cells[k][t], c_.n[t], series.points[t]);
        if (series.parameters) {
          series.points[t].theory = theory(dumps_.front(), *series.parameters, c_.n[t]);
        }
      }
    }
  }

  void finish(const Cell& cell, std::uint64_t n, ConvergePoint& point) const {
    const auto count = static_cast<double>(dumps_.size());
    point.n = n;
    point.metrics = cell.sums;
    for (double& value : point.metrics.values) value /= count;
    point.parts = decompose(cell.pictures, picture_, reference_.width(),
                            reference_.options().epsilon, c_.region);
    point.neighbors = cell.neighbors / count;
    point.radius = cell.radius;
  }

  // The set alone, as psf filter runs it: one run over all passes tells the time of every n at
  // which blocks end; the others have runs of their own.
  void measure_time(std::size_t set) {
    const filter::Parameters& parameters = c_.sets[set];
    const std::uint64_t all = c_.n.back();
    const run::Dump& dump = dumps_.front();
    std::vector<ConvergePoint>& points = series_[set + 1].points;
    run::FilterRequest run;
    run.parameters = parameters;
    run.passes.last = static_cast<std::size_t>(all);
    run.max_memory = c_.max_memory;
    run.on_progress = [this](std::uint64_t done, std::uint64_t total) { progress(done, total); };
    std::vector<std::size_t> places;
    for (std::size_t t = 0; t < c_.n.size(); ++t) {
      const filter::Blocks blocks(parameters.block, dump.pass_bounds(), 0, c_.n[t]);
      if (c_.n[t] == all || blocks.is_whole(blocks.count() - 1)) {
        run.snapshots.push_back(c_.n[t]);
        places.push_back(t);
      } else {
        run::FilterRequest part = run;
        part.passes.last = static_cast<std::size_t>(c_.n[t]);
        part.snapshots.clear();
        part.on_progress = nullptr;
        points[t].filter_seconds = seconds_of(part);
      }
    }
    std::size_t place = 0;
    const auto start = Clock::now();
    run.on_snapshot = [&](std::uint64_t, std::span<const run::CameraPictures>) {
      points[places[place++]].filter_seconds = seconds_since(start);
    };
    static_cast<void>(run::filter_dump(dump, run));
    ++done_;
  }
  [[nodiscard]] double seconds_of(const run::FilterRequest& run) const {
    const auto start = Clock::now();
    static_cast<void>(run::filter_dump(dumps_.front(), run));
    return seconds_since(start);
  }

  void progress(std::uint64_t done, std::uint64_t total) const {
    if (c_.on_progress) c_.on_progress(done_ * total + done, runs_ * total);
  }

  const metrics::Reference& reference_;
  std::span<const Rgb> picture_;
  const ConvergeRequest& c_;
  std::vector<run::Dump> dumps_;
  std::vector<ConvergeSeries> series_;
  std::uint64_t runs_ = 0, done_ = 0;
};

}  // namespace

std::vector<std::uint64_t> powers_up_to(std::uint64_t passes) {
  std::vector<std::uint64_t> n;
  for (std::uint64_t k = 1; k < passes; k *= 2) n.push_back(k);
  n.push_back(passes);
  return n;
}

void check_replicates(std::span<const std::string> dumps, std::uint64_t passes) {
  std::vector<run::Dump> opened;
  opened.reserve(dumps.size());
  for (const std::string& path : dumps) opened.emplace_back(path);
  check_replicates(opened, passes);
}

std::vector<ConvergeSeries> converge(std::span<const std::string> dumps,
                                     const metrics::Reference& reference,
                                     std::span<const Rgb> reference_picture,
                                     const ConvergeRequest& convergence) {
  return Study(dumps, reference, reference_picture, convergence).run();
}

double local_slope(double n0, double value0, double n1, double value1) {
  if (!(value0 > 0) || !(value1 > 0) || !(n1 > n0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return std::log(value1 / value0) / std::log(n1 / n0);
}

}  // namespace psf::study
