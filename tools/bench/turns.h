// Two ways to do the same work, measured in turn.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <vector>

#include "bench/rows.h"

namespace psf::bench {

// A row is not measured again when its runs took so long, whatever --repeat says.
inline constexpr double kEnoughSeconds = 120;

// Seconds that `first` and `second` return, run in turn: both see the same machine.
struct Turns {
  std::vector<double> first, second;

  template <class First, class Second>
  Turns(std::size_t repeat, const First& run_first, const Second& run_second) {
    double total = 0;
    while (first.size() < repeat && total < kEnoughSeconds) {
      first.push_back(run_first());
      second.push_back(run_second());
      total += first.back() + second.back();
    }
  }

  [[nodiscard]] Spread ratio() const {
    std::vector<double> ratios;
    for (std::size_t k = 0; k < first.size(); ++k) ratios.push_back(first[k] / second[k]);
    return spread(ratios);
  }
  [[nodiscard]] std::string detail() const {
    return fmt::format("{:.3g} / {:.3g} s, {} pair{} of runs", spread(first).median,
                       spread(second).median, first.size(), first.size() == 1 ? "" : "s");
  }
};

}  // namespace psf::bench
