#include "render/job/frames.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/seconds.h"
#include "render/loop/recorder.h"

namespace psf::render {
namespace {

// Adds the figures of a frame to those of all.
void add(JobResult frame, JobResult& all) {
  RenderResult& sum = all.render;
  RenderResult& one = frame.render;
  sum.films = std::move(one.films);
  sum.passes += one.passes;
  sum.paths += one.paths;
  sum.rays += one.rays;
  sum.non_finite += one.non_finite;
  sum.seconds += one.seconds;
  sum.output_seconds += one.output_seconds;
  sum.interrupted = one.interrupted;
  sum.out_of_time = one.out_of_time;
  all.scene = frame.scene;
  all.prepare_seconds += frame.prepare_seconds;
  all.images.insert(all.images.end(), frame.images.begin(), frame.images.end());
  all.bytes = all.bytes.value_or(0) + frame.bytes.value_or(0);
}

}  // namespace

void check_frame_names(const Job& job) {
  const bool apart = is_numbered(job.output);
  for (const std::string& image : job.images) {
    if (is_numbered(image) || (job.settings.frames->count == 1 && !apart)) continue;
    throw Error(ErrorCode::usage,
                fmt::format("{}: a picture a frame needs {} in its name, for the frame's number",
                            image, kNumberMark));
  }
}

bool has_channel(const std::vector<std::string>& names, std::string_view channel) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return name == channel || name == kAllChannels;
  });
}

Job with_frame_channel(Job job) {
  std::vector<std::string>& channels = job.settings.channels;
  if (!job.settings.frames || has_channel(channels, "frame")) return job;
  if (channels.empty()) channels.emplace_back(kDefaultChannels);
  channels.emplace_back("frame");
  return job;
}

JobResult run_apart(const Job& job) {
  const FrameRange range = *job.settings.frames;
  const auto start = core::Clock::now();
  JobResult all;
  for (std::uint32_t k = 0; k < range.count; ++k) {
    const std::uint32_t frame = range.first + k;
    Job one = job;
    one.settings.frames = FrameRange{frame, 1};
    one.settings.time_limit = job.settings.time_limit - core::seconds_since(start);
    one.output = numbered(job.output, frame);
    for (std::string& image : one.images) image = numbered(image, frame);
    add(run_job(one), all);
    if (all.render.interrupted || all.render.out_of_time) break;
  }
  return all;
}

}  // namespace psf::render
