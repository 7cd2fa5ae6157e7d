// Rows of the table of psf-render's options, by the kind of their values.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/number.h"
#include "render/job/job.h"
#include "render/job/option_text.h"
#include "render/job/options.h"

namespace psf::render {

// A number of a job from `least` to `most`.
template <class Member, class T = std::decay_t<std::invoke_result_t<Member, Job&>>>
[[nodiscard]] Option number_option(const char* name, const char* group, Member member, T least,
                                   T most, const char* help, const char* type = "N") {
  const bool bounded = most < std::numeric_limits<T>::max();
  Option option{name, type, group, help};
  option.expected = fmt::format(
      "{} {}", std::is_integral_v<T> ? "a whole number" : "a number",
      bounded ? fmt::format("from {} to {}", least, most) : fmt::format("of at least {}", least));
  Job standard;
  const T value = member(standard);
  if (std::isfinite(static_cast<double>(value))) option.standard = fmt::format("{}", value);
  option.set = [member, least, most](Job& job, const std::string& text) {
    const auto given = core::parse_number<T>(text);
    if (!given || *given < least || *given > most) return false;
    member(job) = *given;
    return true;
  };
  return option;
}

// One of some names.
template <class Member, class T = std::decay_t<std::invoke_result_t<Member, Job&>>>
[[nodiscard]] Option choice_option(const char* name, const char* group, Member member,
                                   std::vector<std::pair<std::string, T>> choices,
                                   const char* help) {
  Option option{name, "", group, help};
  Job standard;
  for (const auto& [text, value] : choices) {
    option.type += (option.type.empty() ? "" : "|") + text;
    if (value == member(standard)) option.standard = text;
  }
  option.expected = "one of " + option.type;
  option.set = [member, choices = std::move(choices)](Job& job, const std::string& text) {
    const auto found = std::find_if(choices.begin(), choices.end(),
                                    [&](const auto& one) { return one.first == text; });
    if (found == choices.end()) return false;
    member(job) = found->second;
    return true;
  };
  return option;
}

// Three numbers of the overrides.
template <class Member>
[[nodiscard]] Option triple_option(const char* name, const char* group, Member member,
                                   const char* help) {
  Option option{name, "X,Y,Z", group, help, "three numbers X,Y,Z"};
  option.set = [member](Job& job, const std::string& text) {
    auto& target = member(job.overrides);
    using Number = std::decay_t<decltype(target->x)>;
    const auto parsed = parse_triple<Number>(text);
    if (parsed) target.emplace(parsed->x, parsed->y, parsed->z);
    return parsed.has_value();
  };
  return option;
}

// Whatever set(job, text) takes, which returns false for what it does not.
template <class Set>
[[nodiscard]] Option parsed_option(const char* name, const char* type, const char* group,
                                   std::string expected, const char* help, Set set,
                                   const char* standard = "") {
  Option option{name, type, group, help, std::move(expected), standard};
  option.set = std::move(set);
  return option;
}

}  // namespace psf::render
