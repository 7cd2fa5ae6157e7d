// The vertices of one path, as the table `vertices` of a dump has them: formats/README.md, "Tables".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "render/light/layers.h"
#include "render/light/surface.h"

namespace psf::render {

enum class Lobe : std::uint8_t { none = 0, diffuse = 1, glossy = 2, perfect = 3 };
constexpr std::uint8_t kTransmitted = 8;  // added to the number of a lobe

struct PathVertex {
  Vec3 position{0, 0, 0};
  float distance = 0;       // from the vertex before, or the camera
  Vec3 normal{0, 0, 0};     // unit shading normal on the side that the path came from
  Vec3 direction{0, 0, 0};  // unit, toward where the path came from
  Rgb emission{0, 0, 0};    // radiance emitted along `direction`, weighted against light sampling
  Rgb direct{0, 0, 0};      // radiance scattered along it that light sampling found
  Rgb throughput{0, 0, 0};  // of the segment that goes on; 0 where the path ends
  Rgb background{0, 0, 0};  // radiance that comes along that segment and that no other vertex has
  Vec3 outgoing{0, 0, 0};   // unit, of that segment
  float pdf = 0;            // density of `outgoing`; infinity for perfect lobes
  Rgb reflectance{0, 0, 0};
  float roughness = 0;  // perceptual, of the smoothest lobe; 0 where nothing is scattered
  std::uint32_t material = 0;
  std::uint8_t lobe = 0;  // Lobe, and kTransmitted
  bool selected = false;  // it is x_i
};

// Fed by the steps of a path in their order. Keeps the first vertices up to a number; what those
// behind them bring is the background of the last.
class Trail {
 public:
  explicit Trail(std::size_t most) : most_(most) {}

  void clear();
  [[nodiscard]] std::span<const PathVertex> vertices() const { return vertices_; }

  // The path has arrived at a surface, and met this emission on the way back.
  void arrive(const Surface& surface, const Vec3& direction, float distance);
  // Radiance emitted where the path has arrived, or in the sky, where it has left the scene.
  void meet(const Rgb& radiance, bool escaped);
  // How the surface scatters, as far as it does.
  void scatters(const Rgb& reflectance, float roughness);
  void select();
  // Radiance that light sampling found at the surface.
  void add_direct(const Rgb& radiance);
  // What is scattered here, directly and further on, counts so much more.
  void scale(float factor);
  // The path goes on.
  void leave(const Vec3& direction, float pdf, const Rgb& throughput, std::uint8_t lobe);
  // Russian roulette let it go on, and so it counts so much more; or not.
  void survive(float factor);
  // It went through a medium. What is lost before the first vertex, by a camera in a body, is taken
  // off what that one scatters.
  void attenuate(const Rgb& factor);
  void end();

 private:
  [[nodiscard]] PathVertex& last() { return vertices_.back(); }

  std::size_t most_;
  std::vector<PathVertex> vertices_;
  bool beyond_ = false;  // behind the last vertex that is kept
  Rgb weight_{1, 1, 1};  // behind it: throughput from its segment to the last surface
  Rgb choice_{1, 1, 1};  // factors of scale() at this vertex, before leave()
  Rgb before_{1, 1, 1};  // before the first vertex
};

// What is told of one path beside its record.
struct PathDetails {
  LayerSums layers;        // empty, or those of the integrator
  Trail* trail = nullptr;  // null: its vertices are not wanted
};

}  // namespace psf::render
