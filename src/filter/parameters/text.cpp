#include "filter/parameters/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "filter/parameters/values.h"

namespace psf::filter {
namespace {

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
  if constexpr (kInfo.threshold != nullptr) {
    p.weights.*kInfo.threshold = parse_threshold(kInfo.name, text);
  } else {
    p.weights.*kInfo.is_on = parse_switch(kInfo.name, text);
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
            p.estimator = static_cast<Estimator>(parse_name("estimator", text, estimator_names()));
          }};
}

constexpr std::string_view kCountNames[] = {"samples", "blocks"};         // of RadiusCount
constexpr std::string_view kPixelRuleNames[] = {"keep", "regress"};       // of PixelRule
constexpr std::string_view kFitNames[] = {"mean", "linear"};              // of BallFit
constexpr std::string_view kEngineNames[] = {"flann", "plain", "brute"};  // of EngineKind

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
     [](Parameters& p, const std::string& text) { p.radius.delta = parse_real("delta", text); }},
    {"radius-count",
     "samples|blocks",
     "what n counts",
     "of samples, blocks",
     {},
     [](const Parameters& p) {
       return std::string(kCountNames[static_cast<std::size_t>(p.radius.count)]);
     },
     [](Parameters& p, const std::string& text) {
       p.radius.count = static_cast<RadiusCount>(parse_name("radius-count", text, kCountNames));
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
       p.iterations = parse_count("iterations", text);
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
       if (text != "off") p.agree = parse_real("agree", text);
     }},
    {"fit",
     "mean|linear",
     "what of a ball is taken: its mean, or what is linear in place and normal, at its centre",
     "of mean, linear",
     {},
     [](const Parameters& p) { return std::string(kFitNames[static_cast<std::size_t>(p.fit)]); },
     [](Parameters& p, const std::string& text) {
       p.fit = static_cast<BallFit>(parse_name("fit", text, kFitNames));
     }},
    {"fireflies",
     "RULE",
     "of contributions far brighter than those around them: keep them, spread each over a distance "
     "of its own, or clamp:K, dim them to K sqrt(n) times what is ordinary",
     "keep,spread,clamp:4",
     {},
     [](const Parameters& p) { return to_text(p.fireflies); },
     [](Parameters& p, const std::string& text) { p.fireflies = parse_fireflies(text); }},
    {"pixels",
     "keep|regress",
     "what is left of noise in single pixels of the filtered picture: keep it, or take a linear "
     "fit "
     "over the pixels around that can have the same mean",
     "of keep, regress",
     {},
     [](const Parameters& p) {
       return std::string(kPixelRuleNames[static_cast<std::size_t>(p.pixels)]);
     },
     [](Parameters& p, const std::string& text) {
       p.pixels = static_cast<PixelRule>(parse_name("pixels", text, kPixelRuleNames));
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
       p.engine = static_cast<EngineKind>(parse_name("search", text, kEngineNames));
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
