// Resuming a dump that was stopped: the state that each commit keeps, and the check that the
// settings are the same.
#pragma once

#include <cstdint>
#include <string>

#include "formats/layout/head.h"
#include "formats/write/writer.h"
#include "render/loop/render.h"

namespace psf::render {

// The work that the loop had done by a commit.
struct Done {
  std::uint64_t passes = 0, rays = 0;
  std::uint64_t non_finite = 0;  // paths left out of the pictures
  double seconds = 0;
};

// The resume state for formats::Writer::commit().
[[nodiscard]] std::string resume_state(const Done& done, const RenderSettings& settings);

// Reads the resume state of a file that formats::Writer::resume() opened. `head` is the present
// result of make_head(). Throws Error{bad_input} that names the first setting that differs from the
// file's, or what the file lacks to be continued.
[[nodiscard]] Done resume_point(const formats::Writer& writer, const formats::Head& head,
                                const RenderSettings& settings, std::uint64_t paths_a_pass);

}  // namespace psf::render
