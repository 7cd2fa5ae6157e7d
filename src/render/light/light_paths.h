// Light path segments: paths that start at the lights and carry their power from surface to
// surface.
#pragma once

#include <functional>
#include <iterator>
#include <vector>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "render/light/transport.h"

namespace psf::render {

// Power that arrives at a surface. Lengths, and so the areas in what emits, are those of the
// scene's space.
struct LightVertex {
  Vertex at;           // `out` points to where the light came from
  Rgb power;           // flux, as if this path were all: the mean over paths is what arrives
  std::size_t light;   // number of the light that it left, Lights::count() for the sky
  std::uint64_t path;  // number of the path in its set
  int depth;           // surfaces met since the light; 1 for light that comes straight
};

// Traces sets of paths from the lights. A path is a pure function of the scene, the settings of the
// integrator, those of the sampler, the pass and its number in the set.
//
// A light, or the sky, is chosen by power, and a ray by the light it carries; a light at infinity
// shines through a disk as wide as the scene. The power is then scattered as materials scatter it,
// including what interpolated normals change in that (flux_correction()), through mirrors and
// glass, until max_depth, or Russian roulette, which looks at the power that is left after
// roulette_depth.
class LightPaths {
 public:
  // `transport` must outlive it.
  explicit LightPaths(const Transport& transport) : transport_(transport) {}

  using Visit = std::function<void(const LightVertex&)>;
  // Traces path number `path` with the numbers of `sampler` and calls `visit` at each surface that
  // it meets, before it is scattered there, also where it is absorbed. Adds the number of rays to
  // `rays`.
  void trace(std::uint64_t path, Sampler& sampler, std::uint64_t& rays, const Visit& visit) const;

  // The numbers of a path of a set that belongs to a pass. The paths of all passes are one sequence
  // of the render's kind of sampler, apart from those of the pixels. pass * paths + path < 2^40.
  [[nodiscard]] static Sampler sampler(const SamplerSettings& settings, std::uint64_t pass,
                                       std::uint64_t paths, std::uint64_t path);

  // Some of the paths of a set.
  struct Some {
    std::uint64_t first, count;
  };

  // Traces the set of a pass on all threads. keep(vertex, kept) appends to `kept` what is wanted of
  // a vertex, a std::vector<T>; they come in the order of the paths.
  template <class T, class Keep>
  [[nodiscard]] std::vector<T> collect(const SamplerSettings& settings, std::uint64_t pass,
                                       std::uint64_t paths, std::uint64_t& rays,
                                       const Keep& keep) const {
    return collect_some<T>(settings, pass, paths, {0, paths}, rays, keep);
  }
  // The same of a part of the set.
  template <class T, class Keep>
  [[nodiscard]] std::vector<T> collect_some(const SamplerSettings& settings, std::uint64_t pass,
                                            std::uint64_t paths, const Some& some,
                                            std::uint64_t& rays, const Keep& keep) const {
    constexpr std::size_t kPathsATask = 256;
    std::vector<std::vector<T>> parts(core::range_count(some.count, kPathsATask));
    std::vector<std::uint64_t> shot(parts.size());
    core::parallel_for(some.count, kPathsATask, [&](std::size_t begin, std::size_t end) {
      const std::size_t part = begin / kPathsATask;
      // What is missing then is of a pass that is dropped.
      for (std::size_t k = some.first + begin; k < some.first + end && !core::overdue(); ++k) {
        Sampler numbers = sampler(settings, pass, paths, k);
        trace(k, numbers, shot[part], [&](const LightVertex& v) { keep(v, parts[part]); });
      }
    });
    std::size_t count = 0;
    for (const auto& part : parts) count += part.size();
    std::vector<T> all;
    all.reserve(count);
    for (std::size_t part = 0; part < parts.size(); ++part) {
      std::move(parts[part].begin(), parts[part].end(), std::back_inserter(all));
      parts[part] = {};
      rays += shot[part];
    }
    return all;
  }

 private:
  const Transport& transport_;
};

}  // namespace psf::render
