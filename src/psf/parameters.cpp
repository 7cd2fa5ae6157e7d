#include "psf/parameters.h"

#include "filter/parameters/text.h"
#include "psf/library.h"

namespace psf {

Parameters& Parameters::set(std::string_view name, const std::string& text) {
  filter::Parameters checked;
  filter::set_parameter(checked, name, text);
  given_[std::string(name)] = text;
  return *this;
}

Parameters& Parameters::no_weights(bool off) {
  no_weights_ = off;
  return *this;
}

std::string Parameters::get(std::string_view name) const {
  const filter::Parameter& parameter = filter::find_parameter(name);
  filter::Parameters all;
  if (no_weights_) all.weights = filter::WeightTerms::none();
  for (const auto& [given, text] : given_) filter::set_parameter(all, given, text);
  return parameter.text(all);
}

std::vector<ParameterHelp> Parameters::help() {
  std::vector<ParameterHelp> all;
  for (const filter::Parameter& parameter : filter::parameter_table()) {
    all.push_back(
        {parameter.name, parameter.type, parameter.help, parameter.text(filter::Parameters())});
  }
  return all;
}

filter::Parameters to_filter(const Parameters& parameters) {
  filter::Parameters all;
  if (parameters.has_no_weights()) all.weights = filter::WeightTerms::none();
  for (const auto& [name, text] : parameters.given()) filter::set_parameter(all, name, text);
  all.validate();
  return all;
}

filter::TermSet asked_terms(const Parameters& parameters) {
  filter::TermSet asked = 0;
  for (const auto& [name, text] : parameters.given()) {
    const std::optional<filter::Term> term = filter::find_parameter(name).term;
    if (term) asked |= filter::bit(*term);
  }
  return asked;
}

}  // namespace psf
