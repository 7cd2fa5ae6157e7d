#include "parameter_lists.h"

#include <fmt/format.h>

#include "study/parameter_lists.h"

namespace psf::tools {

void add_parameter_lists(CLI::App& command, ParameterLists& lists) {
  for (const filter::Parameter& parameter : filter::parameter_table()) {
    if (*parameter.examples == '\0') continue;  // there is no use in lists of it
    const std::string name = parameter.name;
    command
        .add_option_function<std::string>(
            "--" + name, [&lists, name](const std::string& text) { lists.given[name] = text; },
            fmt::format("{} (default {})", parameter.examples,
                        parameter.text(filter::Parameters())))
        ->type_name("LIST")
        ->group("Lists of parameters");
  }
  command.add_flag("--no-weights", lists.no_weights, "no terms but those given")
      ->group("Lists of parameters");
}

std::vector<filter::Parameters> all_sets(const ParameterLists& lists) {
  std::vector<filter::Parameters> parameters;
  for (const filter::ParameterTexts& set : study::combinations(lists)) {
    parameters.push_back(filter::parameters_of(set));
    parameters.back().validate();
  }
  return parameters;
}

}  // namespace psf::tools
