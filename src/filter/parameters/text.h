// Every parameter as text, both ways, in one table: options, tuned files, attributes of pictures,
// reports and other languages are loops over it.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "filter/parameters/parameters.h"

namespace psf::filter {

// A parameter and its text.
struct Parameter {
  const char* name;      // "r0", "hit-distance"
  const char* type;      // what its text looks like: "R", "T|off", "on|off", "average|disk|..."
  const char* help;      // what it does, a line
  const char* examples;  // values of it, for lists: "4px,8px"
  std::optional<Term> term;
  std::string (*text)(const Parameters&);
  // Throws Error{usage} that names the parameter and says what may be written. Whether the values
  // of all parameters go together is for Parameters::validate().
  void (*set)(Parameters&, const std::string& text);

  [[nodiscard]] bool is_switch() const { return std::string_view(type) == "on|off"; }
};

// In the order of Parameters. count_refusals is not among them: it changes no picture.
[[nodiscard]] std::span<const Parameter> parameter_table();
// Throws Error{usage} that lists the names where there is none of this name.
[[nodiscard]] const Parameter& find_parameter(std::string_view name);

// Sets the parameter of this name; throws what find_parameter() and its `set` throw.
void set_parameter(Parameters& parameters, std::string_view name, const std::string& text);

// The name and the text of every parameter.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> describe(
    const Parameters& parameters);

// Parameters that were given as text; what is not given is the default.
struct ParameterTexts {
  std::map<std::string, std::string> given;  // by name
  bool no_weights = false;                   // switch off the terms that are not given
};
// Throws Error{usage} for names and texts as find_parameter() and `set`; the values may not go
// together, which Parameters::validate() says.
[[nodiscard]] Parameters parameters_of(const ParameterTexts& texts);
// The terms that are among the names.
[[nodiscard]] TermSet asked_terms(const std::map<std::string, std::string>& given);

}  // namespace psf::filter
