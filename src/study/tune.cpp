#include "study/tune.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "run/median_around.h"
#include "study/tiles.h"
#include "study/variants.h"

namespace psf::study {
namespace {

constexpr std::size_t kParts = 4, kFewParts = 2;

using Picture = std::vector<Rgb>;
using Parts = std::vector<Picture>;  // the same picture of every part

class Tuner {
 public:
  Tuner(const run::Dump& dump, const TuneRequest& t) : dump_(dump), t_(t) {
    const filter::CameraView& camera = dump.cameras()[t.camera];
    width_ = camera.width;
    height_ = camera.height;
    tuning_.rows.resize(t.sets.size());
    tiles_.resize(t.sets.size());
    covariances_.resize(t.sets.size());
    u_tiles_ = Tiles(width_, height_);
    tuning_.has_independent_paths = dump.metadata().sampler == "independent";
  }

  TuneResult run() {
    for (const filter::Parameters& set : t_.sets) {
      if (blocks_of(set).count() < kParts) parts_ = kFewParts;
    }
    tuning_.parts = parts_;
    const std::vector<VariantGroup> groups = group_variants(t_.sets);
    traversals_ = split(groups, [this](const VariantGroup& group) {
      return run::radii_at_once(dump_, run_of({&group, 0, group.radii.size()}));
    });
    for (const Traversal& traversal : traversals_) {
      traverse(traversal);
      ++done_;
    }
    tuning_.noise = run::noise_shares(dump_, t_.passes, t_.epsilon, t_.sets[0].sources)[t_.camera];
    ++done_;
    report_progress(0, blocks_of(t_.sets[0]).all().size());
    choose();
    return std::move(tuning_);
  }

 private:
  [[nodiscard]] run::ManyRequest run_of(const Traversal& traversal) const {
    run::ManyRequest run = study::run_of(traversal);
    run.passes = t_.passes;
    run.max_memory = t_.max_memory;
    run.parts = parts_;
    return run;
  }

  [[nodiscard]] filter::Blocks blocks_of(const filter::Parameters& parameters) const {
    return {parameters.block, dump_.pass_bounds(), t_.passes.first,
            run::last_pass(dump_, t_.passes)};
  }

  // `done` of the paths of one reading: there is one for each traversal, and one for the noise.
  void report_progress(std::uint64_t done, std::uint64_t total) const {
    if (t_.on_progress) t_.on_progress(done_ * total + done, (traversals_.size() + 1) * total);
  }

  void traverse(const Traversal& traversal) {
    const VariantGroup& group = *traversal.group;
    run::ManyRequest run = run_of(traversal);
    // Its regression would take u, which all sets share, out of its place; and it takes most of what
    // it takes whatever the set.
    run.parameters.pixels = filter::PixelRule::keep;
    run.on_progress = [this](std::uint64_t done, std::uint64_t total) {
      report_progress(done, total);
    };
    const run::ManyResult outcome = run::filter_many(dump_, run);
    const auto of_parts = [&](const auto& picture_of) {
      Parts parts;
      for (std::size_t part = 0; part < parts_; ++part) {
        parts.push_back(picture_of(outcome.pictures[part * dump_.cameras().size() + t_.camera]));
      }
      return parts;
    };
    const Parts unfiltered =
        of_parts([](const run::ManyPictures& pictures) { return pictures.unfiltered(); });
    const Parts u = of_parts([](const run::ManyPictures& pictures) { return pictures.u(); });
    set_shares(group.parameters);
    if (done_ == 0) {
      guess(unfiltered);
      measure_unfiltered(unfiltered, u);
    }
    const auto filtered = [&](std::size_t k) {
      return of_parts([k](const run::ManyPictures& pictures) { return pictures.filtered(k); });
    };
    std::size_t best = 0;
    for (std::size_t k = 0; k < traversal.count; ++k) {
      TuneRow& row = tuning_.rows[traversal.row(k)];
      measure(filtered(k), unfiltered, u, traversal.row(k));
      row.parameters = t_.sets[traversal.row(k)];
      row.neighbors = outcome.statistics[k].mean_neighbors();
      if (tiles_[traversal.row(k)].sum() < tiles_[traversal.row(best)].sum()) best = k;
    }
    if (done_ == 0) correlate(unfiltered, filtered(best));
  }

  // Sets shares_ to the share of the paths that each part has.
  void set_shares(const filter::Parameters& parameters) {
    const filter::Blocks blocks = blocks_of(parameters);
    shares_.assign(parts_, 0);
    for (std::uint64_t k = 0; k < blocks.count(); ++k) {
      shares_[k % parts_] +=
          static_cast<double>(blocks[k].size()) / static_cast<double>(blocks.all().size());
    }
  }

  template <class Visit>
  void for_pairs(const Visit& visit) const {
    for (std::size_t i = 0; i < parts_; ++i) {
      for (std::size_t j = i + 1; j < parts_; ++j) visit(i, j);
    }
  }

  void guess(const Parts& unfiltered) {
    Picture all(unfiltered[0].size(), Rgb(0, 0, 0));
    for (std::size_t part = 0; part < parts_; ++part) {
      for (std::size_t pixel = 0; pixel < all.size(); ++pixel) {
        all[pixel] += unfiltered[part][pixel] * static_cast<float>(shares_[part]);
      }
    }
    guess_.resize(all.size());
    std::vector<double> component(all.size());
    for (int c = 0; c < 3; ++c) {
      for (std::size_t pixel = 0; pixel < all.size(); ++pixel) {
        component[pixel] = double{all[pixel][c]};
      }
      const std::vector<double> medians = run::median_around(component, width_);
      for (std::size_t pixel = 0; pixel < all.size(); ++pixel) {
        guess_[pixel][c] = static_cast<float>(medians[pixel]);
      }
    }
  }

  // A component of a pixel in two parts.
  struct Place {
    std::size_t pixel;
    int c;
    std::size_t i, j;
    double weight;  // weight of a square in the mean over pixels, colours and pairs
    double shares;  // 1 / (1 / a_i + 1 / a_j)

    [[nodiscard]] double of_i(const Parts& parts) const { return double{parts[i][pixel][c]}; }
    [[nodiscard]] double of_j(const Parts& parts) const { return double{parts[j][pixel][c]}; }
  };

  // Visits every place that is finite in both pictures.
  template <class Visit>
  void each(const Parts& x, const Parts& y, const Visit& visit) const {
    const auto pairs = static_cast<double>(parts_ * (parts_ - 1) / 2);
    const double values = 3 * static_cast<double>(width_ * height_) * pairs;
    for_pairs([&](std::size_t i, std::size_t j) {
      const double shares = shares_[i] * shares_[j] / (shares_[i] + shares_[j]);
      for (std::size_t pixel = 0; pixel < guess_.size(); ++pixel) {
        if (!is_finite(x[i][pixel]) || !is_finite(x[j][pixel]) || !is_finite(y[i][pixel]) ||
            !is_finite(y[j][pixel])) {
          continue;
        }
        for (int c = 0; c < 3; ++c) {
          const double g = double{guess_[pixel][c]};
          visit(Place{pixel, c, i, j, 1 / ((g * g + t_.epsilon) * values), shares});
        }
      }
    });
  }

  void measure_unfiltered(const Parts& unfiltered, const Parts& u) {
    each(unfiltered, u, [&](const Place& at) {
      const double of_all = at.of_i(unfiltered) - at.of_j(unfiltered);
      const double of_u = at.of_i(u) - at.of_j(u);
      tuning_.unfiltered += at.weight * at.shares * of_all * of_all;
      u_tiles_.add(at.pixel, at.weight * at.shares * of_u * of_u);
    });
    tuning_.u_variance = u_tiles_.sum();
  }

  // The noise of a part is what differs from the filtered picture of the other parts; of all where
  // there are two.
  void correlate(const Parts& unfiltered, const Parts& filtered) {
    double together = 0, squares_i = 0, squares_j = 0;
    each(unfiltered, filtered, [&](const Place& at) {
      double truth = 0, count = 0;
      for (std::size_t part = 0; part < parts_; ++part) {
        if (parts_ > kFewParts && (part == at.i || part == at.j)) continue;
        truth += double{filtered[part][at.pixel][at.c]};
        ++count;
      }
      if (!std::isfinite(truth)) return;
      const double a = at.of_i(unfiltered) - truth / count;
      const double b = at.of_j(unfiltered) - truth / count;
      together += at.weight * a * b;
      squares_i += at.weight * a * a;
      squares_j += at.weight * b * b;
    });
    const double squares = std::sqrt(squares_i * squares_j);
    tuning_.correlation = squares > 0 ? together / squares : 0;
  }

  void measure(const Parts& filtered, const Parts& unfiltered, const Parts& u, std::size_t row) {
    Tiles tiles(width_, height_), covariances(width_, height_);
    TuneRow& result = tuning_.rows[row];
    result.bias_sq = result.variance = 0;
    each(filtered, unfiltered, [&](const Place& at) {
      const double f_i = at.of_i(filtered), f_j = at.of_j(filtered);
      const double bias_sq = at.weight * (f_i - at.of_i(unfiltered)) * (f_j - at.of_j(unfiltered));
      const double spread = (f_i - at.of_i(u)) - (f_j - at.of_j(u));
      const double variance = at.weight * at.shares * spread * spread;
      result.bias_sq += bias_sq;
      result.variance += variance;
      tiles.add(at.pixel, bias_sq + variance);
      const double of_u = at.of_i(u) - at.of_j(u);
      covariances.add(at.pixel, at.weight * at.shares * 2 * spread * of_u);
    });
    result.standard_error = tiles.standard_error();
    tiles_[row] = std::move(tiles);
    covariances_[row] = std::move(covariances);
  }

  void choose() {
    std::vector<TuneRow>& rows = tuning_.rows;
    std::size_t& choice = tuning_.best;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      tuning_.constant = std::min(tuning_.constant, rows[row].bias_sq);
      if (without_u(rows[row]) < without_u(rows[choice])) choice = row;
    }
    tuning_.u_covariance = covariances_[choice].sum();
    const double of_u = tuning_.u_variance + tuning_.u_covariance;
    for (TuneRow& row : rows) row.error = without_u(row) + of_u - tuning_.constant;
    tuning_.unfiltered += tuning_.constant;
    u_tiles_.add(covariances_[choice]);
    const Tiles& best = tiles_[choice];
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (row == choice) continue;
      const double noise = tiles_[row].standard_error_beyond(1, best);
      const double above = rows[row].error - rows[choice].error;
      rows[row].sigmas_above_least = noise > 0 ? above / noise : 0;
      rows[row].may_be_better = may_be_better(tiles_[row], best, of_u);
    }
  }

  static double without_u(const TuneRow& row) { return row.bias_sq + row.variance; }

  // What is added to both errors brings them closer in proportion, so to do without it is the safe
  // side. The constant, which is not above 0 and is taken off both, adds to them; so does u's part
  // where it is above 0. Where it is below, it must not be forgotten.
  [[nodiscard]] bool may_be_better(Tiles other, Tiles best, double of_u) const {
    if (of_u < 0) {
      other.add(u_tiles_);
      best.add(u_tiles_);
    }
    const double more = (1 + kTolerance) * other.sum() - best.sum();
    return more < kSure * other.standard_error_beyond(1 + kTolerance, best);
  }

  const run::Dump& dump_;
  const TuneRequest& t_;
  std::size_t width_ = 0, height_ = 0;
  std::size_t parts_ = kParts;
  std::vector<double> shares_;      // by part: its share of the paths
  Picture guess_;                   // g
  std::vector<Tiles> tiles_;        // by row: bias_sq + variance
  std::vector<Tiles> covariances_;  // by row: twice the covariance of f and u
  Tiles u_tiles_;                   // the variance of u; later all that u adds to the errors
  std::vector<Traversal> traversals_;
  std::uint64_t done_ = 0;  // traversals
  TuneResult tuning_;
};

}  // namespace

TuneResult tune(const run::Dump& dump, const TuneRequest& tune) {
  if (!(std::isfinite(tune.epsilon) && tune.epsilon > 0)) {
    throw Error(ErrorCode::usage, "`epsilon`: must be finite and above 0");
  }
  return Tuner(dump, tune).run();
}

}  // namespace psf::study
