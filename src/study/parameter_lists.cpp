#include "study/parameter_lists.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/number.h"
#include "core/text.h"

namespace psf::study {
namespace {

constexpr std::size_t kMostValues = 1000;  // most values of a list
constexpr double kSlack = 1e-9;  // part of a step: ranges include their end despite rounding

// A number and the unit behind it: "8px".
struct Amount {
  double value = 0;
  std::string unit;
};
std::optional<Amount> parse_amount(const std::string& text) {
  const std::size_t digits = text.find_last_of("0123456789.") + 1;
  const auto number = core::parse_number<double>(std::string_view(text).substr(0, digits));
  if (!number) return std::nullopt;
  return Amount{*number, text.substr(digits)};
}

// To be read: 0.3, not 0.30000000000000004, and 11.314px for 8px times the root of 2.
std::string number_text(double value) {
  return fmt::format("{:.5g}", value);
}

std::vector<std::string> range_values(const std::string& text, const std::string& name) {
  const auto refuse = [&](const char* why) {
    return Error(ErrorCode::usage,
                 fmt::format("`{}`: '{}': {}; write A:B:xFACTOR or A:B:STEP, as in "
                             "2px:32px:x2 or 0.1:0.5:0.1",
                             name, text, why));
  };
  const std::vector<std::string> parts = core::split(text, ':');
  if (parts.size() != 3) throw refuse("a range has three parts");
  const bool by_factor = !parts[2].empty() && parts[2][0] == 'x';
  const auto from = parse_amount(parts[0]), to = parse_amount(parts[1]),
             step = parse_amount(by_factor ? parts[2].substr(1) : parts[2]);
  if (!from || !to || !step) throw refuse("a part is no number");
  const std::string& unit = from->unit.empty() ? to->unit : from->unit;
  const bool one_unit = (from->unit == unit || from->unit.empty()) && to->unit == unit &&
                        (step->unit.empty() || (!by_factor && step->unit == unit));
  if (!one_unit) throw refuse("its units differ");
  if (to->value < from->value) throw refuse("it ends before it begins");
  if (by_factor && !(step->value > 1 && from->value > 0)) {
    throw refuse("a factor is above 1, and what it multiplies above 0");
  }
  if (!by_factor && !(step->value > 0)) throw refuse("a step is above 0");
  std::vector<std::string> values;
  for (std::size_t k = 0;; ++k) {
    const double value = by_factor ? from->value * std::pow(step->value, static_cast<double>(k))
                                   : from->value + static_cast<double>(k) * step->value;
    const double slack = by_factor ? to->value * kSlack : step->value * kSlack;
    if (value > to->value + slack) return values;
    if (values.size() == kMostValues) throw refuse("it has more than 1,000 values");
    values.push_back(number_text(value) + unit);
  }
}

}  // namespace

std::vector<std::string> list_values(const std::string& text, const std::string& name) {
  std::vector<std::string> values;
  for (const std::string& item : core::split(text, ',')) {
    if (item.empty()) {
      throw Error(ErrorCode::usage, fmt::format("`{}`: '{}' has an empty value", name, text));
    }
    const std::vector<std::string> some =
        item.find(':') == std::string::npos ? std::vector{item} : range_values(item, name);
    for (const std::string& value : some) {
      if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
    }
  }
  return values;
}

std::vector<filter::ParameterTexts> combinations(const filter::ParameterTexts& lists) {
  std::vector<filter::ParameterTexts> sets(1);
  sets[0].no_weights = lists.no_weights;
  // Every set with every value of the parameter's list.
  const auto multiply = [&](const std::string& name) {
    const auto list = lists.given.find(name);
    if (list == lists.given.end() || list->second.empty()) return;
    const std::vector<std::string> values = list_values(list->second, name);
    if (sets.size() * values.size() > kMostSets) {
      throw Error(
          ErrorCode::usage,
          fmt::format("`{}`: more than {} combinations; shorten the lists", name, kMostSets));
    }
    std::vector<filter::ParameterTexts> product;
    for (const filter::ParameterTexts& set : sets) {
      for (const std::string& value : values) {
        product.push_back(set);
        product.back().given[name] = value;
      }
    }
    sets = std::move(product);
  };
  for (const auto& [name, list] : lists.given) static_cast<void>(filter::find_parameter(name));
  for (const filter::Parameter& parameter : filter::parameter_table()) {
    const std::string name = parameter.name;
    if (name != "r0" && name != "delta") multiply(name);
  }
  multiply("r0");
  multiply("delta");
  return sets;
}

}  // namespace psf::study
