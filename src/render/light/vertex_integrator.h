// The walk from the camera to x_i, which all integrators of light share; what they add is c_i.
#pragma once

#include <memory>

#include "render/light/integrator.h"
#include "render/light/tally.h"
#include "render/light/transport.h"

namespace psf::render {

// The scene ready for rays, and the layers of its light.
struct LitScene {
  LitScene(const Scene& scene, const IntegratorSettings& settings)
      : transport(scene, settings), plan(settings.layers, transport.lights()) {}
  Transport transport;
  LayerPlan plan;
};

class VertexIntegrator : public Integrator {
 public:
  explicit VertexIntegrator(std::shared_ptr<const LitScene> lit) : lit_(std::move(lit)) {}

  PathRecord trace(const Ray& camera_ray, Sampler& sampler, bool shade, std::uint64_t& rays,
                   const PathDetails& details) const override;
  const std::vector<LayerInfo>& layers() const override { return lit_->plan.layers(); }
  const Transport* light_transport() const override { return &lit_->transport; }
  bool has_volumes() const override { return lit_->transport.has_volumes(); }
  std::vector<std::string> light_names() const override { return lit_->transport.lights().names(); }
  std::string visibility_rule() const override;

 protected:
  [[nodiscard]] const std::shared_ptr<const LitScene>& lit() const { return lit_; }
  [[nodiscard]] const Transport& transport() const { return lit_->transport; }

  // The way from the camera to x_i.
  struct Segment {
    int depth;       // surface interactions, with that at x_i
    float distance;  // d_i
  };
  // What one continuation from x_i computes, beside its part of c_i.
  struct Branch {
    Sampler& sampler;
    std::uint32_t& visibility;
    float& hit_distance;
    std::uint64_t& rays;
    Tally tally;
    Trail* trail = nullptr;
  };
  // The radiance that one continuation from x_i brings back.
  [[nodiscard]] virtual Rgb gather(const Vertex& x, const Segment& segment,
                                   Branch& branch) const = 0;
  // A part of c_i that is the same for every continuation of a path; `sampler` is where x_i is.
  [[nodiscard]] virtual Rgb gather_once(const Vertex& x, const Segment& segment,
                                        const Sampler& sampler, std::uint64_t& rays,
                                        Tally& tally) const;

  // Adds to `sum` the light that lights send straight to x, as light sampling and one scattered ray
  // find it together. Returns whether the ray met a surface: then `walk` has arrived at `surface`,
  // and what that reflects is still to be added.
  [[nodiscard]] bool gather_direct(const Vertex& x, int depth, Branch& branch, Walk& walk,
                                   Surface& surface, Rgb& sum) const;
  // Takes a walk that was scattered into a body through it, to where it leaves, and adds to `sum` the
  // light that is sampled on the way; does nothing for any other. False where the walk ends. However
  // often it is scattered there, that is the one interaction that has been counted where it came in.
  [[nodiscard]] bool pass_body(Walk& walk, Branch& branch, Rgb& sum) const;
  // Counts the surface at which the walk has arrived; false where the path may not go on.
  [[nodiscard]] bool enter(Walk& walk) const;
  // Adds to `sum` the light that `v` scatters back along the walk, without what v emits.
  void follow(Vertex v, Walk& walk, Branch& branch, Rgb& sum) const;

 private:
  // Takes a walk that began in a body out of it; what light it finds there belongs to u_i. False
  // where the path ends.
  [[nodiscard]] bool leave_body(Walk& walk, Sampler& sampler, std::uint64_t& rays,
                                const Tally& seen, PathRecord& record) const;
  // Fills c_i and what comes with it.
  void shade_vertex(const Vertex& x, const Walk& walk, Sampler& sampler, std::uint64_t& rays,
                    const PathDetails& details, PathRecord& record) const;

  std::shared_ptr<const LitScene> lit_;
};

}  // namespace psf::render
