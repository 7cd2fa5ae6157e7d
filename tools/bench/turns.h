// Measures two ways to do the same work, in turn.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <vector>

#include "bench/rows.h"

namespace psf::bench {

// Where the runs of a row have taken this long, it is not measured again, whatever --repeat says.
inline constexpr double kEnoughSeconds = 120;

// The seconds that two functions return. They are called in turn, so that both meet the same load
// of the machine.
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
