// The texts that are made from a program's command line.
#pragma once

#include <string>
#include <vector>

#include "manual/command_line.h"

namespace psf::manual {

// The page of `command`: the program, or one of its verbs. Source for man(1), section 1. It names
// the pages of all `programs`.
[[nodiscard]] std::string man_page(const std::vector<Command>& programs, const Command& program,
                                   const Command& command);
// The page's name, without section: "psf-filter".
[[nodiscard]] std::string page_name(const Command& program, const Command& command);

// What the shells complete from, each a file of the shell's own language.
[[nodiscard]] std::string bash_completion(const Command& program);
[[nodiscard]] std::string zsh_completion(const Command& program);
[[nodiscard]] std::string fish_completion(const Command& program);

// What a page says beyond the program's help, in paragraphs; empty where there is nothing to add.
[[nodiscard]] std::string prose(const std::string& page);

}  // namespace psf::manual
