// The render loop over passes, cameras and paths: it traces the paths, writes their records and
// sums up the pictures.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "film/film.h"
#include "formats/layout/head.h"
#include "formats/write/writer.h"
#include "render/light/integrator.h"
#include "render/loop/shade_rate.h"
#include "render/sample/sampler.h"
#include "render/scene/scene.h"

namespace psf::render {

// Frames of a sequence, which has RenderSettings::passes passes of each, frame by frame.
struct FrameRange {
  std::uint32_t first = 0, count = 1;
};

struct RenderSettings {
  IntegratorSettings integrator;  // for metadata alone; render() gets the integrator itself
  SamplerSettings sampler;
  std::uint64_t passes = 16;          // a pass has width * height paths for each camera
  std::vector<std::size_t> cameras;   // indices into Scene::cameras; empty: all
  std::optional<FrameRange> frames;   // of the file; none: frame 0, of which the file tells nothing
  std::uint32_t shade_rate = 1;       // K, 1 to kMostShadeRate: one path in K is shaded
  std::vector<std::string> channels;  // optional channels to write; empty: those of the default
  double time_limit = std::numeric_limits<double>::infinity();  // seconds; the pass is finished
  bool replay = true;  // on resume, read the passes of the file back into the films
  std::string producer = "psf-render";
  bool quiet = false;                                                        // no bar on stderr
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // paths

  [[nodiscard]] FrameRange frame_range() const { return frames.value_or(FrameRange{}); }
  [[nodiscard]] std::uint64_t total_passes() const { return passes * frame_range().count; }
  // Throws Error{usage} for what is out of range, Error{limit} for more paths than can be numbered.
  void validate(const Scene& scene) const;
};

struct RenderResult {
  std::vector<film::Film> films;  // the unfiltered picture of each chosen camera
  // Where a file was resumed, these include the earlier runs. All passes are committed.
  std::uint64_t passes = 0, paths = 0, rays = 0;
  std::uint64_t non_finite = 0;  // paths left out of the pictures
  double seconds = 0;            // time of the loop
  double output_seconds = 0;     // part of it spent waiting for compression and writing
  bool interrupted = false;      // ^C ended it before the last pass
  bool out_of_time = false;      // RenderSettings::time_limit did
};

// The frame of a sequence that render() is to render: each has its scene.
struct FrameOf {
  std::uint32_t index = 0;               // in RenderSettings::frames
  const formats::Head* head = nullptr;   // of the file; null: make_head() of this scene
  const RenderResult* before = nullptr;  // that of the frame before, in this run
};

// The cameras that are rendered: settings.cameras, or all of the scene's.
[[nodiscard]] std::vector<std::size_t> chosen_cameras(const Scene& scene,
                                                      const RenderSettings& settings);

// The head of the file to write: channels and metadata. `frames`: all cameras at each frame, where
// they differ from frame to frame. Throws Error{limit} where these are too many.
[[nodiscard]] formats::Head make_head(const Scene& scene, const Integrator& integrator,
                                      const RenderSettings& settings,
                                      std::span<const std::vector<Camera>> frames = {});

// Renders. Paths are numbered pass by pass, within a pass camera by camera, and within a camera by
// the enumeration:
//   pixel   path i belongs to pixel i in scanline order; its sample is point `pass` of the pixel's
//           own sequence.
//   global  the path's number in the whole file is its index in one sequence, whose first two
//           dimensions are the image plane.
// `writer`, opened with make_head(), may be null. It gets every record in path order, with one
// commit per pass, and is closed unless ^C ended the loop; a pass that is not whole a second after
// that is dropped, and is in no picture. Where it resumes a file, the loop goes
// on behind the file's last pass, with the same records and pictures as without the interruption;
// it then throws what resume_point() throws. Of a sequence it renders one frame, whose passes are
// those with the numbers from frame * passes on of every sequence of numbers: so a frame has the same
// records whatever frames stand before it. The file is closed with the last one. Compression, writing
// and summing up overlap the tracing of the next slab. The output is the same for any number of
// threads.
[[nodiscard]] RenderResult render(const Scene& scene, const Integrator& integrator,
                                  const RenderSettings& settings, formats::Writer* writer,
                                  const FrameOf& frame = {});

[[nodiscard]] std::string to_string(SamplerKind kind);
[[nodiscard]] std::string to_string(Enumeration enumeration);

}  // namespace psf::render
