#include "filter/parameters/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace psf::filter {
namespace {

// The whole of `text` as a number. Unlike those of core::parse_number() it may be infinite, as a
// threshold may.
template <typename T>
std::optional<T> number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

bool strip_suffix(std::string_view& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.remove_suffix(suffix.size());
  return true;
}

std::string to_text(const std::optional<float>& threshold) {
  return threshold ? fmt::format("{}", *threshold) : "off";
}
std::string to_text(bool on) {
  return on ? "on" : "off";
}

// `text` is not what the parameter may be.
[[noreturn]] void refuse(std::string_view name, std::string_view text, std::string_view why) {
  throw Error(ErrorCode::usage, fmt::format("`{}`: '{}' {}", name, text, why));
}

// The place of `text` among the names of an enumeration, as the value that has it.
template <class Enum, class Names>
Enum parse_name(const char* name, const std::string& text, const Names& names) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end())
    refuse(name, text, fmt::format("is none: write {}", fmt::join(names, ", ")));
  return static_cast<Enum>(found - names.begin());
}

template <class T>
T parse_number(const char* name, const std::string& text) {
  const bool has_plus = text.starts_with('+') && !text.starts_with("+-");
  const std::optional<T> value = number<T>(std::string_view(text).substr(has_plus ? 1 : 0));
  if (!value || std::isnan(static_cast<double>(*value))) refuse(name, text, "is no number");
  return *value;
}

bool parse_switch(const char* name, const std::string& text) {
  if (text != "on" && text != "off") refuse(name, text, "is neither on nor off");
  return text == "on";
}

void parse_radius(const std::string& text, Radius& radius) {
  std::string_view rest = text;
  RadiusBasis basis = RadiusBasis::distance;
  if (strip_suffix(rest, "px")) {
    basis = RadiusBasis::footprint;
  } else if (strip_suffix(rest, "wu")) {
    basis = RadiusBasis::world;
  }
  const std::optional<double> r0 = number<double>(rest);
  if (!r0 || !(*r0 >= 0)) {
    refuse("r0", text, "is no radius: write 0.02 (of the distance), 8px or 0.5wu (world units)");
  }
  radius.r0 = *r0;
  radius.basis = basis;
}

BlockSize parse_block(const std::string& text) {
  BlockSize block;
  std::string_view rest = text;
  const std::size_t caret = text.find('^');
  if (text == "all") {
    block.kind = BlockSize::Kind::all;
    return block;
  }
  if (caret != std::string::npos) {
    const auto base = number<std::uint32_t>(rest.substr(0, caret));
    const auto exponent = number<std::uint32_t>(rest.substr(caret + 1));
    if (base && exponent && *base >= 2 && *exponent < 64) {
      block.kind = BlockSize::Kind::power;
      block.base = *base;
      block.exponent = *exponent;
      return block;
    }
  } else if (strip_suffix(rest, "passes") || strip_suffix(rest, "pass")) {
    const auto passes = number<std::uint64_t>(rest);
    if (passes && *passes >= 1) {
      block.kind = BlockSize::Kind::passes;
      block.passes = *passes;
      return block;
    }
  }
  refuse("block", text, "is no block: write 2^16 (paths; base >= 2), 1pass, 16passes or all");
}

std::uint32_t parse_sources(const std::string& text) {
  const std::string_view rest = text;
  const auto k = rest.starts_with("1/") ? number<std::uint32_t>(rest.substr(2))
                                        : std::optional<std::uint32_t>(text == "1" ? 1 : 0);
  if (k && *k >= 1) return *k;
  refuse("sources", text, "is no share: write 1/4 or 1");
}

// A term of the table with a threshold or a switch.
template <Term kTerm>
std::string term_text(const Parameters& p) {
  constexpr TermInfo kInfo = info(kTerm);
  if constexpr (kInfo.threshold != nullptr) {
    return to_text(p.weights.*kInfo.threshold);
  } else {
    return to_text(p.weights.*kInfo.is_on);
  }
}
template <Term kTerm>
void set_term(Parameters& p, const std::string& text) {
  constexpr TermInfo kInfo = info(kTerm);
  if constexpr (kInfo.threshold == nullptr) {
    p.weights.*kInfo.is_on = parse_switch(kInfo.name, text);
  } else if (text == "off") {
    (p.weights.*kInfo.threshold).reset();
  } else {
    const std::optional<float> value = number<float>(text);
    if (!value || !(*value == *value)) refuse(kInfo.name, text, "is neither a number nor off");
    p.weights.*kInfo.threshold = value;
  }
}
template <Term kTerm>
constexpr Parameter term_row() {
  constexpr TermInfo kInfo = info(kTerm);
  constexpr bool kHasThreshold = kInfo.threshold != nullptr;
  return {kInfo.name,      kHasThreshold ? "T|off" : "on|off",
          kInfo.condition, kHasThreshold ? "thresholds and off" : "of on, off",
          kTerm,           term_text<kTerm>,
          set_term<kTerm>};
}

std::vector<std::string_view> estimator_names() {
  std::vector<std::string_view> names;
  for (const EstimatorInfo& estimator : estimators()) names.push_back(estimator.name);
  return names;
}

Parameter estimator_row() {
  static const std::string type = fmt::format("{}", fmt::join(estimator_names(), "|"));
  static const std::string help = [] {
    std::vector<std::string> parts;
    for (const EstimatorInfo& e : estimators()) {
      parts.push_back(fmt::format("{}{}{}", e.name, e.meaning.empty() ? "" : ": ", e.meaning));
    }
    return fmt::format("{}", fmt::join(parts, "; "));
  }();
  return {"estimator",
          type.c_str(),
          help.c_str(),
          "as of psf filter: average,disk,...",
          {},
          [](const Parameters& p) { return std::string(info(p.estimator).name); },
          [](Parameters& p, const std::string& text) {
            p.estimator = parse_name<Estimator>("estimator", text, estimator_names());
          }};
}

constexpr std::array<const char*, 2> kCountNames = {"samples", "blocks"};         // of RadiusCount
constexpr std::array<const char*, 3> kEngineNames = {"flann", "plain", "brute"};  // of EngineKind

const Parameter kBeforeTerms[] = {
    {"r0",
     "R",
     "radius: 8px, 0.02 of the distance, 0.5wu",
     "radii: 4px,8px or 2px:32px:x2",
     {},
     [](const Parameters& p) { return to_text(p.radius); },
     [](Parameters& p, const std::string& text) { parse_radius(text, p.radius); }},
    {"delta",
     "D",
     "radius shrinks like n^(-delta/2); in [0, 1), 0 keeps it",
     "0,0.33 or 0.1:0.9:0.1",
     {},
     [](const Parameters& p) { return fmt::format("{}", p.radius.delta); },
     [](Parameters& p, const std::string& text) {
       p.radius.delta = parse_number<double>("delta", text);
     }},
    {"radius-count",
     "samples|blocks",
     "what n counts",
     "of samples, blocks",
     {},
     [](const Parameters& p) {
       return std::string(kCountNames[static_cast<std::size_t>(p.radius.count)]);
     },
     [](Parameters& p, const std::string& text) {
       p.radius.count = parse_name<RadiusCount>("radius-count", text, kCountNames);
     }},
    {"block",
     "B",
     "paths averaged with each other: 2^16, 16passes, all",
     "1pass,4passes,2^16,all",
     {},
     [](const Parameters& p) { return to_text(p.block); },
     [](Parameters& p, const std::string& text) { p.block = parse_block(text); }},
};

const Parameter kAfterTerms[] = {
    {"demodulate",
     "on|off",
     "average c / rho and multiply by rho: textures stay sharp",
     "of on, off",
     {},
     [](const Parameters& p) { return to_text(p.demodulate); },
     [](Parameters& p, const std::string& text) {
       p.demodulate = parse_switch("demodulate", text);
     }},
    {"iterations",
     "N",
     "filter so many times, each time what the time before gave",
     "1,2",
     {},
     [](const Parameters& p) { return fmt::format("{}", p.iterations); },
     [](Parameters& p, const std::string& text) {
       p.iterations = parse_number<std::uint32_t>("iterations", text);
     }},
    {"sources",
     "1/K",
     "use only this share of the contributions",
     "1/1,1/4",
     {},
     [](const Parameters& p) { return fmt::format("1/{}", p.sources); },
     [](Parameters& p, const std::string& text) { p.sources = parse_sources(text); }},
    estimator_row(),
    // Its text is "off" where it means nothing, and "off" leaves it as it is.
    {"agree",
     "N",
     "of the estimator adaptive: a ball grows while what is around it differs by at most so many "
     "standard errors",
     "standard errors, of the estimator adaptive",
     {},
     [](const Parameters& p) {
       return info(p.estimator).least_share < 1 ? fmt::format("{}", p.agree) : std::string("off");
     },
     [](Parameters& p, const std::string& text) {
       if (text != "off") p.agree = parse_number<double>("agree", text);
     }},
    {"search",
     "flann|plain|brute",
     "engine: flann; the same result from plain FLANN, a search a record, or by brute force",
     "",
     {},
     [](const Parameters& p) {
       return std::string(kEngineNames[static_cast<std::size_t>(p.engine)]);
     },
     [](Parameters& p, const std::string& text) {
       p.engine = parse_name<EngineKind>("search", text, kEngineNames);
     }},
};

// A row for each term, in their order.
template <std::size_t... kTerm>
std::vector<Parameter> term_rows(std::index_sequence<kTerm...>) {
  return {term_row<static_cast<Term>(kTerm)>()...};
}

std::vector<Parameter> make_table() {
  std::vector<Parameter> table(std::begin(kBeforeTerms), std::end(kBeforeTerms));
  const std::vector<Parameter> terms = term_rows(std::make_index_sequence<kTermCount>());
  table.insert(table.end(), terms.begin(), terms.end());
  table.insert(table.end(), std::begin(kAfterTerms), std::end(kAfterTerms));
  return table;
}

}  // namespace

std::string to_text(const Radius& radius) {
  constexpr std::array<const char*, 3> kUnits = {"", "px", "wu"};  // of RadiusBasis
  return fmt::format("{}{}", radius.r0, kUnits[static_cast<std::size_t>(radius.basis)]);
}

std::string to_text(const BlockSize& block) {
  switch (block.kind) {
    case BlockSize::Kind::power:
      return fmt::format("{}^{}", block.base, block.exponent);
    case BlockSize::Kind::passes:
      return fmt::format("{}{}", block.passes, block.passes == 1 ? "pass" : "passes");
    case BlockSize::Kind::all:
      break;
  }
  return "all";
}

std::span<const Parameter> parameter_table() {
  static const std::vector<Parameter> table = make_table();
  return table;
}

const Parameter& find_parameter(std::string_view name) {
  std::vector<std::string_view> names;
  for (const Parameter& parameter : parameter_table()) {
    if (name == parameter.name) return parameter;
    names.emplace_back(parameter.name);
  }
  throw Error(ErrorCode::usage, fmt::format("there is no parameter '{}'; there are {}", name,
                                            fmt::join(names, ", ")));
}

void set_parameter(Parameters& parameters, std::string_view name, const std::string& text) {
  find_parameter(name).set(parameters, text);
}

Parameters parameters_of(const ParameterTexts& texts) {
  Parameters parameters;
  if (texts.no_weights) parameters.weights = WeightTerms::none();
  for (const auto& [name, text] : texts.given) set_parameter(parameters, name, text);
  return parameters;
}

TermSet asked_terms(const std::map<std::string, std::string>& given) {
  TermSet asked = 0;
  for (const auto& [name, text] : given) {
    const std::optional<Term> term = find_parameter(name).term;
    if (term) asked |= bit(*term);
  }
  return asked;
}

std::vector<std::pair<std::string, std::string>> describe(const Parameters& parameters) {
  std::vector<std::pair<std::string, std::string>> texts;
  for (const Parameter& parameter : parameter_table()) {
    texts.emplace_back(parameter.name, parameter.text(parameters));
  }
  return texts;
}

}  // namespace psf::filter
