#include "parameter_lists.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "filter_options.h"
#include "option_values.h"

namespace psf::tools {
namespace {

constexpr std::size_t kMostValues = 1000;  // most values of a list
constexpr double kSlack = 1e-9;  // part of a step: ranges include their end despite rounding

std::vector<std::string> split(const std::string& text, char by) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(by, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

// A number and the unit behind it: "8px".
struct Amount {
  double value = 0;
  std::string unit;
};
std::optional<Amount> parse_amount(const std::string& text) {
  const std::size_t digits = text.find_last_of("0123456789.") + 1;
  const auto number = parse_number<double>(std::string_view(text).substr(0, digits));
  if (!number) return std::nullopt;
  return Amount{*number, text.substr(digits)};
}

// To be read: 0.3, not 0.30000000000000004, and 11.314px for 8px times the root of 2.
std::string number_text(double value) {
  return fmt::format("{:.5g}", value);
}

std::vector<std::string> range_values(const std::string& text, const char* option) {
  const auto refuse = [&](const char* why) {
    return Error(ErrorCode::usage, fmt::format("{}: '{}': {}; write A:B:xFACTOR or A:B:STEP, as in "
                                               "2px:32px:x2 or 0.1:0.5:0.1",
                                               option, text, why));
  };
  const std::vector<std::string> parts = split(text, ':');
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

bool parse_switch(const std::string& text, const char* option) {
  if (text == "on" || text == "off") return text == "on";
  throw Error(ErrorCode::usage, fmt::format("{}: '{}' is neither on nor off", option, text));
}

template <class T>
T parse_value(const std::string& text, const char* option) {
  const auto number = parse_number<T>(text);
  if (number) return *number;
  throw Error(ErrorCode::usage, fmt::format("{}: '{}' is no number", option, text));
}

}  // namespace

std::vector<std::string> list_values(const std::string& text, const char* option) {
  std::vector<std::string> values;
  for (const std::string& item : split(text, ',')) {
    if (item.empty()) {
      throw Error(ErrorCode::usage, fmt::format("{}: '{}' has an empty value", option, text));
    }
    const std::vector<std::string> some =
        item.find(':') == std::string::npos ? std::vector{item} : range_values(item, option);
    for (const std::string& value : some) {
      if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
    }
  }
  return values;
}

void add_parameter_lists(CLI::App& command, ParameterLists& lists) {
  const auto add = [&command](const char* name, std::string& text, const char* type,
                              const char* help) {
    command.add_option(name, text, help)->type_name(type)->group("Lists of parameters");
  };
  add("--r0", lists.r0, "LIST", "radii: 4px,8px or 2px:32px:x2 (default 8px)");
  add("--delta", lists.delta, "LIST", "0,0.33 or 0.1:0.9:0.1 (default 0.333)");
  add("--radius-count", lists.radius_count, "LIST", "of samples, blocks (default samples)");
  add("--block", lists.block, "LIST", "1pass,4passes,2^16,all (default 4passes)");
  add("--normal", lists.normal, "LIST", "thresholds and off: 0.9,0.95,off (default 0.95)");
  add("--reflectance", lists.reflectance, "LIST", "thresholds and off (default 0.05)");
  add("--visibility", lists.visibility, "LIST", "of on, off (default on)");
  add("--hit-distance", lists.hit_distance, "LIST", "thresholds and off (default off)");
  add("--plane", lists.plane, "LIST", "thresholds and off (default off)");
  add("--direction", lists.direction, "LIST", "thresholds and off (default off)");
  add("--gloss", lists.gloss, "LIST", "thresholds and off (default 0.8)");
  add("--material", lists.material, "LIST", "of on, off (default off)");
  add("--demodulate", lists.demodulate, "LIST", "of on, off (default off)");
  add("--iterations", lists.iterations, "LIST", "1,2 (default 1)");
  add("--sources", lists.sources, "LIST", "1/1,1/4 (default 1/1)");
  add("--estimator", lists.estimator, "LIST",
      "as of psf filter: average,disk,... (default average)");
  add("--agree", lists.agree, "LIST", "standard errors, of the estimator adaptive");
  command.add_flag("--no-weights", lists.no_weights, "no terms but those given")
      ->group("Lists of parameters");
}

std::vector<filter::Parameters> all_sets(const ParameterLists& lists) {
  std::vector<ParameterOptions> sets(1);
  sets[0].no_weights = lists.no_weights;
  // Every set with every value of the list.
  const auto multiply = [&sets](const std::string& list, const char* option, const auto& assign) {
    if (list.empty()) return;
    const std::vector<std::string> values = list_values(list, option);
    if (sets.size() * values.size() > kMostSets) {
      throw Error(ErrorCode::usage, fmt::format("{}: more than {} combinations; shorten the lists",
                                                option, kMostSets));
    }
    std::vector<ParameterOptions> product;
    for (const ParameterOptions& set : sets) {
      for (const std::string& value : values) {
        product.push_back(set);
        assign(product.back(), value);
      }
    }
    sets = std::move(product);
  };
  const auto text_of = [](std::string ParameterOptions::*member) {
    return [member](ParameterOptions& set, const std::string& value) { set.*member = value; };
  };
  using Options = ParameterOptions;
  multiply(lists.estimator, "--estimator", text_of(&Options::estimator));
  multiply(lists.agree, "--agree", [](Options& set, const std::string& value) {
    set.agree = parse_value<decltype(set.agree)>(value, "--agree");
  });
  multiply(lists.block, "--block", text_of(&Options::block));
  multiply(lists.radius_count, "--radius-count", [](Options& set, const std::string& value) {
    if (value != "samples" && value != "blocks") {
      throw Error(ErrorCode::usage,
                  fmt::format("--radius-count: '{}' is neither samples nor blocks", value));
    }
    set.radius_count = value;
  });
  multiply(lists.normal, "--normal", text_of(&Options::normal));
  multiply(lists.reflectance, "--reflectance", text_of(&Options::reflectance));
  multiply(lists.visibility, "--visibility", [](Options& set, const std::string& value) {
    set.visibility = parse_switch(value, "--visibility");
  });
  multiply(lists.hit_distance, "--hit-distance", text_of(&Options::hit_distance));
  multiply(lists.plane, "--plane", text_of(&Options::plane));
  multiply(lists.direction, "--direction", text_of(&Options::direction));
  multiply(lists.gloss, "--gloss", text_of(&Options::gloss));
  multiply(lists.material, "--material", [](Options& set, const std::string& value) {
    set.material = parse_switch(value, "--material");
  });
  multiply(lists.demodulate, "--demodulate", [](Options& set, const std::string& value) {
    set.demodulate = parse_switch(value, "--demodulate");
  });
  multiply(lists.iterations, "--iterations", [](Options& set, const std::string& value) {
    set.iterations = parse_value<std::uint32_t>(value, "--iterations");
  });
  multiply(lists.sources, "--sources", text_of(&Options::sources));
  multiply(lists.r0, "--r0", text_of(&Options::r0));
  multiply(lists.delta, "--delta", [](Options& set, const std::string& value) {
    set.delta = parse_value<double>(value, "--delta");
  });
  std::vector<filter::Parameters> parameters;
  parameters.reserve(sets.size());
  for (const ParameterOptions& set : sets) parameters.push_back(parameters_of(set));
  return parameters;
}

}  // namespace psf::tools
