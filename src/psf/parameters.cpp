#include "psf/parameters.h"

#include "filter/parameters/text.h"
#include "psf/library.h"
#include "study/parameter_lists.h"

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
  return filter::find_parameter(name).text(filter::parameters_of({given_, no_weights_}));
}

std::vector<ParameterHelp> Parameters::help() {
  std::vector<ParameterHelp> all;
  for (const filter::Parameter& parameter : filter::parameter_table()) {
    all.push_back(
        {parameter.name, parameter.type, parameter.help, parameter.text(filter::Parameters())});
  }
  return all;
}

std::vector<Parameters> Parameters::combinations(const std::map<std::string, std::string>& lists,
                                                 bool no_weights) {
  std::vector<Parameters> sets;
  for (const filter::ParameterTexts& texts : study::combinations({lists, no_weights})) {
    sets.emplace_back().no_weights(no_weights);
    for (const auto& [name, text] : texts.given) sets.back().set(name, text);
  }
  return sets;
}

run::PassSelection to_run(const Passes& passes) {
  run::PassSelection selection;
  selection.first = static_cast<std::size_t>(passes.first);
  if (passes.last) selection.last = static_cast<std::size_t>(*passes.last);
  return selection;
}

filter::Parameters to_filter(const Parameters& parameters) {
  filter::Parameters all = filter::parameters_of({parameters.given(), parameters.has_no_weights()});
  all.validate();
  return all;
}

}  // namespace psf
