// A render from a scene file to files: all that psf-render does but its command line and what it
// prints.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/write/writer.h"
#include "render/loop/render.h"
#include "render/scene/load.h"

namespace psf::render {

struct Job {
  std::string scene;
  std::string output;                      // the .pvb file; empty: none
  std::vector<std::string> images;         // .exr or .png of the unfiltered picture
  std::vector<std::string> other_outputs;  // files that the caller writes: none of these
  std::vector<std::string> cameras;        // names; empty: the first; "all"
  bool resume = false;                     // go on with `output` where it is there
  formats::Codec codec = formats::Codec::zstd;
  double fps = 24;  // frames a second, for scenes that count in seconds
  SceneOverrides overrides;
  RenderSettings settings;  // its cameras and producer are set by run_job()
  std::string version;      // of psf
  std::function<void(const std::string& note)> on_note;  // a line for the user; none: dropped
};

struct JobResult {
  std::string scene;  // its name
  RenderResult render;
  double prepare_seconds = 0;          // until the first path
  std::vector<std::string> images;     // the files that were written
  std::optional<std::uint64_t> bytes;  // of the dump

  [[nodiscard]] double rays_per_second() const;
};

// Renders, and writes dump and pictures, of each frame where there are several: the dump gets one
// frame after the other, or its name has #### for the number of the frame, and each gets a dump;
// what ^C stopped is written as far as it came. Throws Error{usage} for a camera that is not there,
// an output that is an input or another output, or a name that is none of a dump or a picture;
// Error{io} where a file cannot be written; Error{limit} for a scene so far away that the dump's
// positions could not tell its vertices apart; and what load_scene(), validate() and render()
// throw.
[[nodiscard]] JobResult run_job(const Job& job);

// Throws Error{interrupted} that says what is kept, where ^C stopped the job.
void throw_if_stopped(const Job& job, const JobResult& result);

// The file of psf-render --json, without its last newline.
[[nodiscard]] std::string figures(const Job& job, const JobResult& result);

}  // namespace psf::render
