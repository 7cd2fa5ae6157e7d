#include "study/tune.h"

#include <algorithm>
#include <cmath>

#include "study/variants.h"

namespace psf::study {
namespace {

constexpr std::size_t kTile = 8;  // pixels; noise of tiles is taken for independent

constexpr std::size_t kParts = 4, kFewParts = 2;

using Picture = std::vector<Rgb>;
using Parts = std::vector<Picture>;  // the same picture of every part

// Sums over tiles of the picture, so that means have standard errors although neighbouring pixels
// share neighbours.
class Tiles {
 public:
  Tiles() = default;
  Tiles(std::size_t width, std::size_t height)
      : width_(width),
        columns_((width + kTile - 1) / kTile),
        values_(columns_ * ((height + kTile - 1) / kTile)) {}

  void add(std::size_t pixel, double value) {
    values_[pixel / width_ / kTile * columns_ + pixel % width_ / kTile] += value;
    sum_ += value;
  }
  [[nodiscard]] double sum() const { return sum_; }
  // Standard error of the sum of these minus that of others.
  [[nodiscard]] double standard_error(const Tiles* other = nullptr) const {
    const auto count = static_cast<double>(values_.size());
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < values_.size(); ++k) {
      const double value = values_[k] - (other != nullptr ? other->values_[k] : 0);
      sum += value;
      squares += value * value;
    }
    if (count < 2) return 0;
    const double variance = std::max(0.0, (squares - sum * sum / count) / (count - 1));
    return std::sqrt(variance * count);
  }

 private:
  std::size_t width_ = 1, columns_ = 1;
  std::vector<double> values_;
  double sum_ = 0;
};

class Tuner {
 public:
  Tuner(const Dump& dump, const Tune& t) : dump_(dump), t_(t) {
    const filter::CameraView& camera = dump.cameras()[t.camera];
    width_ = camera.width;
    height_ = camera.height;
    tuning_.rows.resize(t.sets.size());
    tiles_.resize(t.sets.size());
    tuning_.has_independent_paths = dump.metadata().sampler == "independent";
  }

  Tuning run() {
    for (const filter::Parameters& set : t_.sets) {
      if (blocks_of(set).count() < kParts) parts_ = kFewParts;
    }
    tuning_.parts = parts_;
    const std::vector<VariantGroup> groups = group_variants(t_.sets);
    traversals_ = split(groups, [this](const VariantGroup& group) {
      return radii_at_once(dump_, run_of({&group, 0, group.radii.size()}));
    });
    for (const Traversal& traversal : traversals_) {
      traverse(traversal);
      ++done_;
    }
    choose();
    return std::move(tuning_);
  }

 private:
  [[nodiscard]] ManyRun run_of(const Traversal& traversal) const {
    ManyRun run = study::run_of(traversal);
    run.passes = t_.passes;
    run.max_memory = t_.max_memory;
    run.parts = parts_;
    return run;
  }

  [[nodiscard]] filter::Blocks blocks_of(const filter::Parameters& parameters) const {
    return {parameters.block, dump_.pass_bounds(), t_.passes.first, last_pass(dump_, t_.passes)};
  }

  void traverse(const Traversal& traversal) {
    const VariantGroup& group = *traversal.group;
    const std::size_t count = traversal.count;
    ManyRun run = run_of(traversal);
    run.on_progress = [this](std::uint64_t done, std::uint64_t total) {
      if (t_.on_progress) t_.on_progress(done_ * total + done, traversals_.size() * total);
    };
    const ManyOutcome outcome = filter_many(dump_, run);
    const auto pictures_of = [&](std::size_t part) -> const ManyPictures& {
      return outcome.pictures[part * dump_.cameras().size() + t_.camera];
    };
    const auto filtered = [&](std::size_t k) {
      Parts parts;
      for (std::size_t part = 0; part < parts_; ++part) {
        parts.push_back(pictures_of(part).filtered(k));
      }
      return parts;
    };
    Parts unfiltered;
    for (std::size_t part = 0; part < parts_; ++part) {
      unfiltered.push_back(pictures_of(part).unfiltered());
    }
    set_shares(group.parameters);
    if (done_ == 0) {
      guess_by_median(filtered, count);
      std::size_t best = 0;
      for (std::size_t k = 0; k < count; ++k) {
        measure(filtered(k), unfiltered, traversal.row(k));
        const auto error = [&](std::size_t of) { return tiles_[traversal.row(of)].sum(); };
        if (error(k) < error(best)) best = k;
      }
      const Parts chosen = filtered(best);
      guesses_.clear();
      for_pairs([&](std::size_t i, std::size_t j) { guesses_.push_back(guess(chosen, i, j)); });
      measure_unfiltered(unfiltered);
    }
    for (std::size_t k = 0; k < count; ++k) {
      TuneRow& row = tuning_.rows[traversal.row(k)];
      measure(filtered(k), unfiltered, traversal.row(k));
      row.parameters = t_.sets[traversal.row(k)];
      row.neighbors = outcome.statistics[k].mean_neighbors();
    }
  }

  // Of the paths, how many are in each part.
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

  // g for the parts i and j: the mean of all others, the darker of the two where there are none.
  [[nodiscard]] Picture guess(const Parts& parts, std::size_t i, std::size_t j) const {
    Picture picture(parts[0].size(), Rgb(0, 0, 0));
    if (parts_ == kFewParts) {
      for (std::size_t pixel = 0; pixel < picture.size(); ++pixel) {
        for (int c = 0; c < 3; ++c) {
          picture[pixel][c] = std::min(parts[i][pixel][c], parts[j][pixel][c]);
        }
      }
      return picture;
    }
    const auto share = 1 / static_cast<float>(parts_ - 2);
    for (std::size_t part = 0; part < parts_; ++part) {
      if (part == i || part == j) continue;
      for (std::size_t pixel = 0; pixel < picture.size(); ++pixel) {
        picture[pixel] += parts[part][pixel] * share;
      }
    }
    return picture;
  }

  // The median over the sets, pixel by pixel.
  template <class Filtered>
  void guess_by_median(const Filtered& filtered, std::size_t count) {
    std::vector<std::vector<Picture>> by_set;  // by set and pair
    for (std::size_t k = 0; k < count; ++k) {
      const Parts parts = filtered(k);
      by_set.emplace_back();
      for_pairs([&](std::size_t i, std::size_t j) { by_set[k].push_back(guess(parts, i, j)); });
    }
    guesses_ = by_set[0];
    std::vector<float> values(count);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
    for (std::size_t pair = 0; pair < guesses_.size(); ++pair) {
      for (std::size_t pixel = 0; pixel < guesses_[pair].size(); ++pixel) {
        for (int c = 0; c < 3; ++c) {
          for (std::size_t k = 0; k < count; ++k) values[k] = by_set[k][pair][pixel][c];
          std::nth_element(values.begin(), middle, values.end());
          guesses_[pair][pixel][c] = *middle;
        }
      }
    }
  }

  // A value of a pixel in two parts.
  struct Place {
    std::size_t pixel;
    int c;
    std::size_t i, j;
    double g, weight;  // weight: of its square, over pixels, colours and pairs
    double shares;     // 1 / (1 / a_i + 1 / a_j)

    [[nodiscard]] double of_i(const Parts& parts) const { return double{parts[i][pixel][c]}; }
    [[nodiscard]] double of_j(const Parts& parts) const { return double{parts[j][pixel][c]}; }
  };

  // Visits every place that is finite in both pictures.
  template <class Visit>
  void each(const Parts& x, const Parts& y, const Visit& visit) const {
    const double values = 3 * static_cast<double>(width_ * height_ * guesses_.size());
    std::size_t pair = 0;
    for_pairs([&](std::size_t i, std::size_t j) {
      const Picture& guess = guesses_[pair++];
      const double shares = shares_[i] * shares_[j] / (shares_[i] + shares_[j]);
      for (std::size_t pixel = 0; pixel < guess.size(); ++pixel) {
        if (!is_finite(x[i][pixel]) || !is_finite(x[j][pixel]) || !is_finite(y[i][pixel]) ||
            !is_finite(y[j][pixel]) || !is_finite(guess[pixel])) {
          continue;
        }
        for (int c = 0; c < 3; ++c) {
          const double g = double{guess[pixel][c]};
          visit(Place{pixel, c, i, j, g, 1 / ((g * g + t_.epsilon) * values), shares});
        }
      }
    });
  }

  void measure_unfiltered(const Parts& unfiltered) {
    double together = 0, squares_i = 0, squares_j = 0;
    each(unfiltered, unfiltered, [&](const Place& at) {
      const double a = at.of_i(unfiltered), b = at.of_j(unfiltered);
      tuning_.unfiltered += at.weight * at.shares * (a - b) * (a - b);
      together += at.weight * (a - at.g) * (b - at.g);
      squares_i += at.weight * (a - at.g) * (a - at.g);
      squares_j += at.weight * (b - at.g) * (b - at.g);
    });
    const double squares = std::sqrt(squares_i * squares_j);
    tuning_.correlation = squares > 0 ? together / squares : 0;
  }

  void measure(const Parts& filtered, const Parts& unfiltered, std::size_t row) {
    Tiles tiles(width_, height_);
    TuneRow& result = tuning_.rows[row];
    result.bias_sq = result.variance = 0;
    each(filtered, unfiltered, [&](const Place& at) {
      const double f_i = at.of_i(filtered), f_j = at.of_j(filtered);
      const double bias_sq = at.weight * (f_i - at.of_i(unfiltered)) * (f_j - at.of_j(unfiltered));
      const double variance = at.weight * at.shares * (f_i - f_j) * (f_i - f_j);
      result.bias_sq += bias_sq;
      result.variance += variance;
      tiles.add(at.pixel, bias_sq + variance);
    });
    result.standard_error = tiles.standard_error();
    tiles_[row] = std::move(tiles);
  }

  void choose() {
    std::vector<TuneRow>& rows = tuning_.rows;
    for (const TuneRow& row : rows) tuning_.constant = std::min(tuning_.constant, row.bias_sq);
    for (TuneRow& row : rows) row.error = row.bias_sq + row.variance - tuning_.constant;
    tuning_.unfiltered += tuning_.constant;
    for (std::size_t row = 1; row < rows.size(); ++row) {
      if (rows[row].error < rows[tuning_.least].error) tuning_.least = row;
    }
    tuning_.best = tuning_.least;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (row == tuning_.least) continue;
      const double noise = tiles_[row].standard_error(&tiles_[tuning_.least]);
      const double above = rows[row].error - rows[tuning_.least].error;
      rows[row].distance = noise > 0 ? above / noise : 0;
      if (rows[row].distance < kAlike && rows[row].neighbors < rows[tuning_.best].neighbors) {
        tuning_.best = row;
      }
    }
  }

  const Dump& dump_;
  const Tune& t_;
  std::size_t width_ = 0, height_ = 0;
  std::size_t parts_ = kParts;
  std::vector<double> shares_;    // of a part
  std::vector<Picture> guesses_;  // g, of a pair of parts
  std::vector<Tiles> tiles_;
  std::vector<Traversal> traversals_;
  std::uint64_t done_ = 0;  // traversals
  Tuning tuning_;
};

}  // namespace

Tuning tune(const Dump& dump, const Tune& tune) {
  return Tuner(dump, tune).run();
}

}  // namespace psf::study
