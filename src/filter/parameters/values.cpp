#include "filter/parameters/values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

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

// `text` is not what the parameter may be.
[[noreturn]] void refuse(std::string_view name, std::string_view text, std::string_view why) {
  throw Error(ErrorCode::usage, fmt::format("`{}`: '{}' {}", name, text, why));
}

template <class T>
T parse_number(const char* name, const std::string& text) {
  const bool has_plus = text.starts_with('+') && !text.starts_with("+-");
  const std::optional<T> value = number<T>(std::string_view(text).substr(has_plus ? 1 : 0));
  if (!value || std::isnan(static_cast<double>(*value))) refuse(name, text, "is no number");
  return *value;
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

std::string to_text(const std::optional<float>& threshold) {
  return threshold ? fmt::format("{}", *threshold) : "off";
}

std::string to_text(const FireflyRule& rule) {
  switch (rule.kind) {
    case FireflyRule::Kind::spread:
      return "spread";
    case FireflyRule::Kind::clamp:
      return fmt::format("clamp:{}", rule.limit);
    case FireflyRule::Kind::keep:
      break;
  }
  return "keep";
}

std::string to_text(bool on) {
  return on ? "on" : "off";
}

double parse_real(const char* name, const std::string& text) {
  return parse_number<double>(name, text);
}

std::uint32_t parse_count(const char* name, const std::string& text) {
  return parse_number<std::uint32_t>(name, text);
}

bool parse_switch(const char* name, const std::string& text) {
  if (text != "on" && text != "off") refuse(name, text, "is neither on nor off");
  return text == "on";
}

std::optional<float> parse_threshold(const char* name, const std::string& text) {
  if (text == "off") return std::nullopt;
  const std::optional<float> value = number<float>(text);
  if (!value || std::isnan(*value)) refuse(name, text, "is neither a number nor off");
  return value;
}

std::size_t parse_name(const char* name, const std::string& text,
                       std::span<const std::string_view> names) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end())
    refuse(name, text, fmt::format("is none: write {}", fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
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

FireflyRule parse_fireflies(const std::string& text) {
  if (text == "keep") return {};
  if (text == "spread") return {FireflyRule::Kind::spread};
  constexpr std::string_view kClamp = "clamp:";
  if (text.starts_with(kClamp)) {
    const auto limit = number<double>(std::string_view(text).substr(kClamp.size()));
    if (limit && *limit >= 1 && std::isfinite(*limit)) return {FireflyRule::Kind::clamp, *limit};
  }
  refuse("fireflies", text, "is no rule: write keep, spread, or clamp:4 (a number of at least 1)");
}

std::uint32_t parse_sources(const std::string& text) {
  const std::string_view rest = text;
  const auto k = rest.starts_with("1/") ? number<std::uint32_t>(rest.substr(2))
                                        : std::optional<std::uint32_t>(text == "1" ? 1 : 0);
  if (k && *k >= 1) return *k;
  refuse("sources", text, "is no share: write 1/4 or 1");
}

}  // namespace psf::filter
