// The pictures that other denoisers take, made from the paths of a dump: what Open Image Denoise,
// NFOR and BCD would get from a renderer that wrote for them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "export/export.h"
#include "run/dump.h"
#include "run/passes.h"
#include "run/unfiltered_paths.h"

namespace psf::exports {

enum class Denoiser : std::uint8_t {
  oidn,  // Open Image Denoise, its program oidnDenoise
  nfor,  // Bitterli et al. 2016, the program `denoiser` of Tungsten
  bcd    // Boughida and Boubekeur 2017, its program bcd_cli
};
inline constexpr std::array<std::string_view, 3> kDenoiserNames = {"oidn", "nfor", "bcd"};

struct DenoiserResult {
  run::UnfilteredCounts paths;
  // Numbers of pixels with no and with one path in the picture.
  std::uint64_t without_path = 0, with_one_path = 0;
  std::vector<std::string> files;
  std::uint64_t bytes = 0;         // size of all files
  std::vector<std::string> notes;  // what was left out and why, a line each
};

// Writes a folder with the pictures of the paths of the selection; of a dump with several cameras a
// folder in it for each, called as in film/picture_names.h. The colours are those of the picture
// without filter of `psf filter`, background included; what it leaves out is left out here, and
// counted. Features are means over all these paths, of which those without vertex count as 0. A
// feature whose channel the dump lacks is left out, with a note. `folder` must be empty or not
// exist; `version` is that of the program, for the pictures' attributes. The memory depends on the
// pictures, not on the dump; README.md has it. Throws what for_each_unfiltered_path() throws,
// Error{io}, Error{interrupted}.
[[nodiscard]] DenoiserResult export_for(Denoiser denoiser, const run::Dump& dump,
                                        const run::PassSelection& passes, const std::string& folder,
                                        const std::string& version,
                                        const ExportProgress& progress = {});

}  // namespace psf::exports
