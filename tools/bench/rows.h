// Rows of a benchmark, each a figure with its spread and its target, printed as a table or JSON.
#pragma once

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace psf::bench {

struct Spread {
  double median = 0, min = 0, max = 0;
};
// The spread of at least one value.
[[nodiscard]] Spread spread(std::vector<double> values);

struct Target {
  enum class Kind { at_least, at_most } kind = Kind::at_most;
  double value = 0;

  [[nodiscard]] bool is_met(double median) const {
    return kind == Kind::at_least ? median >= value : median <= value;
  }
};

struct Row {
  std::string name;  // for programs: "read_raw_1"
  std::string what;  // description for people
  std::string unit;  // "x" for ratios, "%", "s", "GB/s"
  Spread value;
  std::optional<Target> target;  // not set: the row is for information
  std::string detail;            // the numbers that the figure was computed from
};

// The seconds of real time that a call takes.
template <class Call>
[[nodiscard]] double seconds_of(const Call& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void print_table(const std::vector<Row>& rows);
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<Row>& rows);
// Throws Error{comparison} that names the rows whose target is missed.
void require_targets(const std::vector<Row>& rows);

}  // namespace psf::bench
