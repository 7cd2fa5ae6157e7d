// What psf converge prints.
#pragma once

#include "study/converge_file.h"

namespace psf::tools {

// A table a series: errors, slopes, bias and variance, M(n), radius, speed-ups.
void print_convergence(const study::ConvergeReport& report);
// Measured slopes beside those of theory.
void print_checks(const study::ConvergeReport& report);

}  // namespace psf::tools
