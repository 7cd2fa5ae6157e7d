// Files that a program reads and files that it writes are told apart before it does anything.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace psf::core {

// Throws Error{usage} where writing an output would overwrite an input or another output, whatever
// names lead to it: links of both kinds, "." and "..", standard output that is redirected to it.
// Empty names are ignored; a device or a pipe may be input and output at once. The files need not
// exist, and none is opened.
void check_apart(std::span<const std::string> inputs, std::span<const std::string> outputs);

// Checks files before anything is done: check_apart(), and Error{io} where an output cannot be
// written. Empty names are ignored.
void check_files(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

}  // namespace psf::core
