// The text that psf converge prints.
#pragma once

#include "study/converge_file.h"

namespace psf::tools {

// Prints a table for each series: errors, slopes, bias and variance, M(n), radius, speed-ups.
void print_convergence(const study::ConvergeReport& report);
// Prints measured slopes beside those that theory predicts.
void print_checks(const study::ConvergeReport& report);

}  // namespace psf::tools
