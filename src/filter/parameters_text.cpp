#include "filter/parameters_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "core/error.h"

namespace psf::filter {
namespace {

// The whole of `text` as a number.
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
std::string to_text(search::Kind kind) {
  return kind == search::Kind::flann ? "flann" : kind == search::Kind::plain ? "plain" : "brute";
}

}  // namespace

void parse_radius(const std::string& text, Radius& radius) {
  std::string_view rest = text;
  RadiusBasis basis = RadiusBasis::distance;
  if (strip_suffix(rest, "px"))
    basis = RadiusBasis::footprint;
  else if (strip_suffix(rest, "wu"))
    basis = RadiusBasis::world;
  const std::optional<double> r0 = number<double>(rest);
  if (!r0 || !(*r0 >= 0)) {
    throw Error(ErrorCode::usage,
                fmt::format("--r0: '{}' is no radius: write 0.02 (of the distance), "
                            "8px or 0.5wu (world units)",
                            text));
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
  throw Error(ErrorCode::usage,
              fmt::format("--block: '{}' is no block: write 2^16 (paths; base >= 2), "
                          "1pass, 16passes or all",
                          text));
}

std::uint32_t parse_sources(const std::string& text) {
  const std::string_view rest = text;
  const auto k = rest.starts_with("1/") ? number<std::uint32_t>(rest.substr(2))
                                        : std::optional<std::uint32_t>(text == "1" ? 1 : 0);
  if (k && *k >= 1) return *k;
  throw Error(ErrorCode::usage, fmt::format("--sources: '{}' is no share: write 1/4 or 1", text));
}

Estimator parse_estimator(const std::string& text) {
  const auto found = std::find(kEstimatorNames.begin(), kEstimatorNames.end(), text);
  if (found != kEstimatorNames.end()) {
    return static_cast<Estimator>(found - kEstimatorNames.begin());
  }
  throw Error(ErrorCode::usage, fmt::format("--estimator: '{}' is none: write {}", text,
                                            fmt::join(kEstimatorNames, ", ")));
}

std::optional<float> parse_threshold(const std::string& text, const char* option) {
  if (text == "off") return std::nullopt;
  const auto value = number<float>(text);
  if (!value || !(*value == *value)) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: '{}' is neither a number nor off", option, text));
  }
  return value;
}

std::string to_text(const Radius& radius) {
  switch (radius.basis) {
    case RadiusBasis::distance:
      break;
    case RadiusBasis::footprint:
      return fmt::format("{}px", radius.r0);
    case RadiusBasis::world:
      return fmt::format("{}wu", radius.r0);
  }
  return fmt::format("{}", radius.r0);
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

std::string to_text(Estimator estimator) {
  return kEstimatorNames[static_cast<std::size_t>(estimator)];
}

std::vector<std::pair<std::string, std::string>> describe(const Parameters& p) {
  return {{"r0", to_text(p.radius)},
          {"delta", fmt::format("{}", p.radius.delta)},
          {"radius-count", p.radius.count == RadiusCount::samples ? "samples" : "blocks"},
          {"block", to_text(p.block)},
          {"normal", to_text(p.weights.normal)},
          {"reflectance", to_text(p.weights.reflectance)},
          {"visibility", to_text(p.weights.visibility)},
          {"hit-distance", to_text(p.weights.hit_distance)},
          {"plane", to_text(p.weights.plane)},
          {"direction", to_text(p.weights.direction)},
          {"material", to_text(p.weights.material)},
          {"gloss", to_text(p.weights.gloss)},
          {"demodulate", to_text(p.demodulate)},
          {"iterations", fmt::format("{}", p.iterations)},
          {"sources", fmt::format("1/{}", p.sources)},
          {"estimator", to_text(p.estimator)},
          {"agree", p.estimator == Estimator::adaptive ? fmt::format("{}", p.agree) : "off"},
          {"search", to_text(p.search)}};
}

}  // namespace psf::filter
