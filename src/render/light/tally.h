// Adds the light of a path to its layers, beside its sum.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/vec.h"
#include "render/light/layers.h"
#include "render/light/lights.h"

namespace psf::render {

// The layers that there are, and where light belongs.
class LayerPlan {
 public:
  static constexpr std::size_t kMost = 32;  // layers

  LayerPlan() = default;
  // Throws Error{usage} for lights of more names than kMost.
  LayerPlan(LayerKind kind, const Lights& lights);

  [[nodiscard]] LayerKind kind() const { return kind_; }
  // What of a light's name may not stand in a channel's is _.
  [[nodiscard]] const std::vector<LayerInfo>& layers() const { return layers_; }
  // The layer of a light, or of the sky for Lights::count(); with `lights` alone.
  [[nodiscard]] std::size_t of_light(std::size_t light) const { return of_light_[light]; }

 private:
  LayerKind kind_ = LayerKind::none;
  std::vector<LayerInfo> layers_;
  std::vector<std::size_t> of_light_;
};

// Adds the light of one path to its layers.
class Tally {
 public:
  Tally() = default;  // counts nothing
  // For u, the light that does not pass through x_i.
  static Tally of_camera(const LayerPlan& plan, const LayerSums& sums) {
    return {plan, sums.unfiltered, kCamera, false};
  }
  // For c, beginning at x_i.
  static Tally of_vertex(const LayerPlan& plan, const LayerSums& sums) {
    return {plan, sums.contribution, 0, plan.kind() == LayerKind::lobes};
  }

  [[nodiscard]] bool counts() const { return !sums_.empty(); }
  // Whether the next light comes straight to x_i, so that set_diffuse() is wanted before add().
  [[nodiscard]] bool wants_diffuse() const { return counts() && at_vertex_; }
  // The share of the light that the diffuse lobe of x_i scatters; the rest is the glossy lobe's.
  void set_diffuse(const Rgb& share) { diffuse_ = share; }
  // The walk was scattered at x_i.
  void leave_vertex() { at_vertex_ = false; }
  // What comes now was reflected between surfaces.
  void bounce() {
    if (counts() && plan_->kind() == LayerKind::bounces && layer_ == 0) layer_ = 1;
  }

  // `light`: its number, Lights::count() for the sky.
  void add(std::size_t light, const Rgb& radiance) {
    if (!counts()) return;
    if (plan_->kind() == LayerKind::lights) {
      sums_[plan_->of_light(light)] += radiance;
    } else if (plan_->kind() == LayerKind::lobes && layer_ != kCamera) {
      const Rgb diffuse = diffuse_ * radiance;
      sums_[0] += diffuse;
      sums_[1] += radiance - diffuse;
    } else {
      sums_[layer_] += radiance;
    }
  }

 private:
  static constexpr std::size_t kCamera = 2;  // number of the layer, of bounces and lobes

  Tally(const LayerPlan& plan, std::span<Rgb> sums, std::size_t layer, bool at_vertex)
      : plan_(&plan), sums_(sums), layer_(layer), at_vertex_(at_vertex) {}

  const LayerPlan* plan_ = nullptr;
  std::span<Rgb> sums_;
  std::size_t layer_ = 0;
  bool at_vertex_ = false;
  Rgb diffuse_{1, 1, 1};
};

}  // namespace psf::render
