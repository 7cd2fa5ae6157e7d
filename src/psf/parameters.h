// The parameters of the filter, each as text by its name, as on the command line of psf filter.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "psf/export.h"

namespace psf {

// A parameter as psf filter --help describes it.
struct ParameterHelp {
  std::string name;      // "r0"
  std::string type;      // stands for its value: "R"
  std::string help;      // what it does
  std::string standard;  // the text of its default: "8px"
};

// A value: the defaults of psf filter, and what was set. What is not set is chosen for a dump: a
// weight whose channel the dump lacks is off. What is set must be possible, or is an error.
class PSF_API Parameters {
 public:
  // Sets a parameter: set("r0", "16px").set("normal", "off"). Throws Error{usage} that says what
  // may be written, or which names there are.
  Parameters& set(std::string_view name, const std::string& text);
  // Switches off the weights that are not set.
  Parameters& no_weights(bool off = true);

  // The text of a parameter, set or not. Throws Error{usage} where there is none of this name.
  [[nodiscard]] std::string get(std::string_view name) const;
  // What was set: names and texts.
  [[nodiscard]] const std::map<std::string, std::string>& given() const { return given_; }
  // Whether the weights that are not set are off.
  [[nodiscard]] bool has_no_weights() const { return no_weights_; }

  // Every combination of lists of values, by the names of parameters, as of psf sweep: "2px,4px",
  // "2px:32px:x2", "0.1:0.5:0.1", "0.9,off". In the order of help(); r0 and delta vary fastest.
  // Throws Error{usage} as set(), and for more than 100,000 of them.
  [[nodiscard]] static std::vector<Parameters> combinations(
      const std::map<std::string, std::string>& lists, bool no_weights = false);

  // Every parameter that there is, in the order of psf filter --help.
  [[nodiscard]] static std::vector<ParameterHelp> help();

 private:
  std::map<std::string, std::string> given_;
  bool no_weights_ = false;
};

}  // namespace psf
