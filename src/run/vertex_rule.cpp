#include "run/vertex_rule.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "core/number.h"

namespace psf::run {
namespace {

constexpr std::string_view kFirstRough = "first-rough";

struct NumberedRule {
  std::string_view name;
  VertexRule::Kind kind;
  double most;
  bool whole;
};
constexpr std::array<NumberedRule, 3> kNumbered = {
    {{"depth", VertexRule::Kind::depth, 65535, true},
     {"roughness", VertexRule::Kind::roughness, 1, false},
     {"distance", VertexRule::Kind::distance, 1e30, false}}};

}  // namespace

VertexRule parse_vertex_rule(const std::string& text) {
  if (text == kFirstRough) return {};
  const std::size_t colon = text.find(':');
  for (const NumberedRule& rule : kNumbered) {
    if (colon == std::string::npos || text.substr(0, colon) != rule.name) continue;
    const auto value = core::parse_number<double>(std::string_view(text).substr(colon + 1));
    const bool fits = value && *value >= 0 && *value <= rule.most &&
                      (!rule.whole || *value == std::floor(*value));
    if (fits) return {rule.kind, *value};
  }
  throw Error(
      ErrorCode::usage,
      fmt::format("vertex: expected first-rough, depth:K with a whole number K, roughness:T "
                  "with 0 <= T <= 1, or distance:D, got \"{}\"",
                  text));
}

std::string to_text(const VertexRule& rule) {
  for (const NumberedRule& numbered : kNumbered) {
    if (numbered.kind == rule.kind) return fmt::format("{}:{}", numbered.name, rule.value);
  }
  return std::string(kFirstRough);
}

std::optional<VertexRule> vertex_rule_of(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(parse_vertex_rule(text));
}

}  // namespace psf::run
