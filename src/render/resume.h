// Going on with a dump that was stopped: what each commit keeps for it, and what must be the same.
#pragma once

#include <cstdint>
#include <string>

#include "formats/head.h"
#include "formats/writer.h"
#include "render/render.h"

namespace psf::render {

// What the loop had done by a commit.
struct Done {
  std::uint64_t passes = 0, rays = 0;
  std::uint64_t non_finite = 0;  // paths left out of the pictures
  double seconds = 0;
};

// For formats::Writer::commit().
[[nodiscard]] std::string resume_state(const Done& done, const RenderSettings& settings);

// Of a file that formats::Writer::resume() opened; `head`: what make_head() gives now. Throws
// Error{bad_input} naming the first setting under which the file was rendered otherwise, or what
// the file lacks to be continued.
[[nodiscard]] Done resume_point(const formats::Writer& writer, const formats::Head& head,
                                const RenderSettings& settings, std::uint64_t paths_a_pass);

}  // namespace psf::render
