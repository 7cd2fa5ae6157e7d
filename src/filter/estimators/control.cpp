#include "filter/estimators/control.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/seconds.h"
#include "filter/estimators/scramble.h"
#include "filter/inputs.h"
#include "filter/orphans.h"
#include "filter/problem.h"

namespace psf::filter {
namespace {

using core::Clock;
using core::seconds_since;

// A number for the pixel of record i that is unique over all cameras.
std::uint64_t pixel_of(const Records& records, std::uint32_t i) {
  const std::uint64_t camera = records.camera.empty() ? 0 : records.camera[i];
  return camera << 32 | records.pixel[i];
}

// The half, 0 or 1, that a record belongs to. Halves are sets of pixels, and differ from block to
// block. All records of a pixel, shaded or not, have about the same control, whose noise cancels in
// the pixel where K times its number of sources is the number of its records.
unsigned half_of(const Records& records, const Block& block, std::uint32_t i) {
  return scramble(~scramble(block.first_path) ^ pixel_of(records, i)) & 1;
}

// Whether the record of this pixel in `pass` is chosen as a source, with probability 1 / k. Of
// every k passes one is chosen, for each pixel by itself. So the choice is independent of g_i,
// which comes from other pixels (a lattice's choice would not be), and all pixels have as many
// sources.
bool is_drawn(std::uint64_t pixel, std::uint64_t pass, std::uint32_t k) {
  const std::uint64_t coin = scramble(scramble(pass / k) ^ pixel);
  return pass % k == ((coin >> 32) * k) >> 32;
}

// beta of a control with noise: 1 less the part of the variance of a mean over `count` sources that
// does not cancel, `share`, over the squared mean; at least 0. `mean` and `mean_sq` are means of
// the luminance and of its square.
float shrunk(double share, double mean, double mean_sq, std::uint32_t count) {
  if (count < 2 || !(mean * mean > 0)) return share > 0 ? 0.0f : 1.0f;
  const double variance = std::max(0.0, mean_sq - mean * mean) / (count - 1);
  return static_cast<float>(std::max(0.0, 1 - share * variance / (mean * mean)));
}

class Control {
 public:
  explicit Control(const MethodInput& input)
      : r_(input.records), radius_(input.radius), block_(input.block), p_(input.parameters) {}

  Estimates run() {
    const auto start = Clock::now();
    choose();
    make_room();
    result_.statistics.seconds_index = seconds_since(start);
    if (k_ == 1) {
      for (const std::uint32_t i : roles_.queries) {
        for (const Part& part : parts_) (*part.c_bar)[i] = part.contribution[i];
        result_.neighbors[i] = 1;
      }
    } else if (k_ > 1) {
      for (const unsigned half : {0u, 1u}) set_controls(half);
      combine();
    }
    for (const std::uint32_t i : roles_.queries) result_.statistics.add_query(result_.neighbors[i]);
    result_.roles = std::move(roles_.of);
    return std::move(result_);
  }

 private:
  // What is estimated: c, and the contributions of the layers.
  struct Part {
    std::span<const Rgb> contribution;
    std::vector<Rgb>* c_bar;  // in the result
  };

  void make_room() {
    result_.neighbors.assign(r_.size(), 0);
    result_.layers.resize(r_.layers.size());
    parts_.push_back({r_.contribution, &result_.c_bar});
    for (std::size_t k = 0; k < r_.layers.size(); ++k) {
      const std::span<const Rgb> contribution = r_.layers[k].contribution;
      if (!contribution.empty()) parts_.push_back({contribution, &result_.layers[k]});
    }
    for (const Part& part : parts_) part.c_bar->assign(r_.size(), Rgb(0, 0, 0));
  }

  // Chooses the sources, and sets k_ to one over their probability, or leaves it where the block
  // has no shaded record.
  void choose() {
    Parameters all = p_;
    all.sources = 1;
    Statistics& counts = result_.statistics;
    roles_ = find_roles(r_, block_, all, counts);
    if (counts.sources == 0) {
      leave_out_queries(roles_.of, counts);
      return;
    }
    k_ = std::uint64_t{shade_rate(counts.queries, counts.sources)} * p_.sources;
    if (p_.sources == 1) return;
    std::vector<std::uint32_t> chosen;
    std::uint64_t pixels = 0;
    for (const CameraView& camera : block_.cameras) {
      pixels += std::uint64_t{camera.width} * camera.height;
    }
    for (std::uint32_t i = 0; i < roles_.of.size(); ++i) {
      Role& role = roles_.of[i];
      if (!is_input(role)) continue;
      const std::uint64_t pass = (block_.first_path + i) / pixels;
      if (!is_drawn(pixel_of(r_, i), pass, p_.sources)) {
        role = role == Role::source ? Role::query : Role::unchosen;
      } else if (role == Role::source) {
        chosen.push_back(i);
      }
    }
    roles_.sources = std::move(chosen);
    counts.sources = roles_.sources.size();
  }

  // The share of a control's noise that does not cancel among the records of a pixel, because the
  // block's passes are not a multiple of k_.
  [[nodiscard]] double noise_share() const {
    const double k = static_cast<double>(k_), passes = std::max(1.0, block_.samples_per_pixel);
    const double rest = std::fmod(passes, k);
    return rest * (k - rest) / (passes * (k - 1));
  }

  // Writes beta g_i to c_bar for the records that are not in `half`, from the sources that are.
  void set_controls(unsigned half) {
    const auto start = Clock::now();
    Roles roles;
    roles.of = roles_.of;
    for (const std::uint32_t i : roles_.queries) {
      const bool source = roles.of[i] == Role::source, inside = half_of(r_, block_, i) == half;
      if (source && inside) roles.sources.push_back(i);
      if (source && !inside) roles.of[i] = Role::query;
      // An engine needs its sources among the queries; their results are not used.
      if ((source && inside) || (!inside && radius_[i] * radius_[i] > 0))
        roles.queries.push_back(i);
    }
    if (roles.sources.empty()) return;
    const Weights weights(r_, terms_in_use(r_, p_.weights));
    const Problem problem{r_, roles, radius_, weights, {}};
    const std::unique_ptr<Engine> engine = make_engine(p_.engine, problem);
    result_.statistics.seconds_index += seconds_since(start);
    const double share = noise_share();

    const auto filter_start = Clock::now();
    // The values of every part, and last the luminance of those of c and its square.
    std::vector<std::vector<Rgb>> values, means;
    for (const Part& part : parts_) {
      values.push_back(p_.demodulate
                           ? demodulated(part.contribution, r_, roles)
                           : std::vector<Rgb>(part.contribution.begin(), part.contribution.end()));
    }
    values.emplace_back(r_.size(), Rgb(0, 0, 0));
    for (const std::uint32_t j : roles.sources) {
      const float y = luminance(values[0][j]);
      values.back()[j] = Rgb(y, y * y, 0);
    }
    means.assign(values.size(), std::vector<Rgb>(r_.size()));
    std::vector<Averaged> all;
    for (std::size_t k = 0; k < values.size(); ++k) all.push_back({values[k], means[k]});
    std::vector<std::uint32_t> counts(r_.size());
    Statistics unused;  // the engine counts queries of `half` as well
    engine->apply(all, BallFit::mean, false, counts, unused);
    for (const std::uint32_t i : roles.queries) {
      if (half_of(r_, block_, i) == half) continue;
      const std::uint32_t count = counts[i] > 0 ? counts[i] : kOrphanSources;
      const Rgb& moments = means.back()[i];
      const float beta = shrunk(share, double{moments.x}, double{moments.y}, count);
      result_.neighbors[i] = counts[i];
      for (std::size_t k = 0; k < parts_.size(); ++k) {
        const Rgb g = p_.demodulate ? remodulate(means[k][i], r_.reflectance[i]) : means[k][i];
        (*parts_[k].c_bar)[i] = g * beta;
      }
    }
    result_.statistics.seconds_filter += seconds_since(filter_start);
  }

  // c'_i from g_i.
  void combine() {
    const auto k = static_cast<float>(k_);
    for (const std::uint32_t i : roles_.queries) {
      result_.statistics.orphans += result_.neighbors[i] == 0 ? 1u : 0u;
      if (roles_.of[i] != Role::source) continue;
      for (const Part& part : parts_) {
        const Rgb g = (*part.c_bar)[i];
        (*part.c_bar)[i] = g + (part.contribution[i] - g) * k;
      }
    }
  }

  const Records& r_;
  std::span<const float> radius_;
  const Block& block_;
  const Parameters& p_;
  Roles roles_;
  std::vector<Part> parts_;
  std::uint64_t k_ = 0;
  Estimates result_;
};

}  // namespace

std::uint32_t shade_rate(std::uint64_t queries, std::uint64_t shaded) {
  const double ratio = static_cast<double>(queries) / static_cast<double>(shaded);
  if (shaded == queries) return 1;
  const double k = std::max(2.0, std::round(ratio));
  // A lattice over few records, or one that the borders of surfaces cut, is off by chance.
  const double tolerance = 0.02 + 4 / std::sqrt(static_cast<double>(shaded));
  if (std::abs(ratio / k - 1) <= tolerance) return static_cast<std::uint32_t>(k);
  throw Error(
      ErrorCode::bad_input,
      fmt::format("`estimator control`: one record in {:.3g} is shaded, but the probability "
                  "must be one over a whole number; render with one shade rate",
                  ratio));
}

Estimates control(const MethodInput& input) {
  return Control(input).run();
}

}  // namespace psf::filter
