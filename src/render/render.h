// The loop over passes, cameras and paths: traces, records, writes and sums up.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "film/film.h"
#include "formats/head.h"
#include "formats/writer.h"
#include "render/integrator.h"
#include "render/sampler.h"
#include "render/scene.h"

namespace psf::render {

struct RenderSettings {
  IntegratorSettings integrator;  // for metadata; the integrator itself is given
  SamplerSettings sampler;
  std::uint64_t passes = 16;          // a pass has width * height paths a camera
  std::vector<std::size_t> cameras;   // indices into Scene::cameras; empty: all
  std::uint32_t shade_rate = 1;       // one path in so many is shaded, 1 to 65536
  std::vector<std::string> channels;  // optional channels to write; empty: all
  double time_limit = std::numeric_limits<double>::infinity();  // seconds; ends after the pass
  bool replay = true;  // of a resumed file: read its passes back into the films
  std::string producer = "psf-render";
  bool quiet = false;

  // Throws Error{usage} for what is out of range, Error{limit} for more paths than can be numbered.
  void validate(const Scene& scene) const;
};

struct RenderResult {
  std::vector<film::Film> films;  // one a chosen camera: the unfiltered pictures
  // With those of the runs before, where a file was resumed; passes are all committed.
  std::uint64_t passes = 0, paths = 0, rays = 0;
  std::uint64_t non_finite = 0;  // paths left out of the pictures
  double seconds = 0;            // all of the loop
  double output_seconds = 0;     // of it, waiting for compression and writing
  bool interrupted = false;      // ^C ended it before the last pass
};

// The cameras that are rendered: settings.cameras, or all of the scene's.
[[nodiscard]] std::vector<std::size_t> chosen_cameras(const Scene& scene,
                                                      const RenderSettings& settings);

// What the file says of itself.
[[nodiscard]] formats::Head make_head(const Scene& scene, const Integrator& integrator,
                                      const RenderSettings& settings);

// Renders. Paths are numbered pass by pass, camera by camera; within it
//   pixel   path i is pixel i in scanline order, its sampler point `pass` of the pixel's sequence;
//   global  its number in the whole file is its index in one sequence, whose first two dimensions
//           are the image plane.
// `writer`, of the head above, or null: gets every record in path order, a commit a pass, and is
// closed unless ^C ended the loop. Where it resumes a file, the loop goes on behind its last pass,
// with the same records and pictures as if it had never stopped; throws what resume_point() throws.
// Compression, writing and summing up overlap the tracing of what comes next. The same bytes for
// any number of threads.
[[nodiscard]] RenderResult render(const Scene& scene, const Integrator& integrator,
                                  const RenderSettings& settings, formats::Writer* writer);

[[nodiscard]] std::string to_string(SamplerKind kind);
[[nodiscard]] std::string to_string(Enumeration enumeration);

}  // namespace psf::render
