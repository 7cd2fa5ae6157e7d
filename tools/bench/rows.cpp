#include "bench/rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace psf::bench {
namespace {

// Percentages are kept as fractions.
std::string shown(double value, const std::string& unit) {
  if (unit == "%") return fmt::format("{:.2f} %", 100 * value);
  return fmt::format("{:.3g} {}", value, unit);
}

std::string target_text(const Row& row) {
  if (!row.target) return "";
  return (row.target->kind == Target::Kind::at_least ? ">= " : "<= ") +
         shown(row.target->value, row.unit);
}

const char* verdict(const Row& row) {
  if (!row.target) return "";
  return row.target->is_met(row.value.median) ? "met" : "MISSED";
}

}  // namespace

Spread spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values.at(half) : (values.at(half - 1) + values.at(half)) / 2;
  return {median, values.front(), values.back()};
}

void print_table(const std::vector<Row>& rows) {
  std::size_t width = 0;
  for (const Row& row : rows) width = std::max(width, row.what.size());
  constexpr const char* kRow = "{:<{}}  {:>11}  {:<23} {:>10}  {:<6}  {}\n";
  fmt::print(kRow, "", width, "median", "min..max", "target", "", "");
  for (const Row& row : rows) {
    fmt::print(kRow, row.what, width, shown(row.value.median, row.unit),
               shown(row.value.min, row.unit) + " .. " + shown(row.value.max, row.unit),
               target_text(row), verdict(row), row.detail);
  }
}

nlohmann::ordered_json to_json(const std::vector<Row>& rows) {
  using Json = nlohmann::ordered_json;
  Json out = Json::array();
  for (const Row& row : rows) {
    Json entry = {{"name", row.name},
                  {"what", row.what},
                  {"unit", row.unit == "%" ? "fraction" : row.unit},
                  {"median", row.value.median},
                  {"min", row.value.min},
                  {"max", row.value.max}};
    if (row.target) {
      entry["target"] = {
          {"kind", row.target->kind == Target::Kind::at_least ? "at_least" : "at_most"},
          {"value", row.target->value}};
      entry["met"] = row.target->is_met(row.value.median);
    }
    entry["detail"] = row.detail;
    out.push_back(std::move(entry));
  }
  return out;
}

void require_targets(const std::vector<Row>& rows) {
  std::vector<std::string> missed;
  for (const Row& row : rows) {
    if (row.target && !row.target->is_met(row.value.median)) missed.push_back(row.name);
  }
  if (missed.empty()) return;
  throw Error(ErrorCode::comparison,
              fmt::format("targets are missed: {}", fmt::join(missed, ", ")));
}

}  // namespace psf::bench
