// The settings of a render as text by name, in one table: the options of psf-render and of
// psf.render() in Python are loops over it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "render/job/job.h"

namespace psf::render {

struct Option {
  std::string name = {};  // "passes", "shade-rate"
  std::string type = {};  // what its text looks like: "N", "sobol|halton|independent", "R,G,B|GREY"
  std::string group = {};     // "Sampling"
  std::string help = {};      // what it does, a line
  std::string expected = {};  // what a text is, for messages: "a whole number of at least 1"
  std::string standard = {};  // the default's text; empty: there is none
  char separator = 0;         // of the values of a list: ',', or 0 where it is given again for each
  bool is_list = false;
  // Sets it, or adds to the list; false where the text is not what is expected.
  std::function<bool(Job&, const std::string& text)> set = {};
};

[[nodiscard]] const std::vector<Option>& option_table();

// Sets the option of this name. Throws Error{usage} that says what may be written, or which names
// there are.
void set_option(Job& job, std::string_view name, const std::string& text);

}  // namespace psf::render
