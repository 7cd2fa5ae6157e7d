// Jobs of several frames: the names of their files, and a job a frame.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/numbered_name.h"
#include "render/job/job.h"

namespace psf::render {

using core::is_numbered;
using core::kNumberMark;
using core::numbered;

// Throws Error{usage} where frames would share a picture.
void check_frame_names(const Job& job);
// A file of frames says of every path which one it is of.
[[nodiscard]] Job with_frame_channel(Job job);
// Whether one of the names, or "all", asks for a channel.
[[nodiscard]] bool has_channel(const std::vector<std::string>& names, std::string_view channel);

// Runs the job once for each frame, with names of their own; the figures are those of all together.
[[nodiscard]] JobResult run_apart(const Job& job);

}  // namespace psf::render
