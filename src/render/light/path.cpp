// Path tracing with light sampling and multiple importance sampling; `direct` is the same cut short
// after x_i.
#include "render/light/integrators.h"
#include "render/light/vertex_integrator.h"

namespace psf::render {

namespace {

class PathIntegrator final : public VertexIntegrator {
 public:
  PathIntegrator(std::shared_ptr<const LitScene> lit, bool indirect)
      : VertexIntegrator(std::move(lit)), indirect_(indirect) {}

 private:
  Rgb gather(const Vertex& x, const Segment& segment, Branch& branch) const override {
    Rgb sum;
    Walk walk;
    Surface surface;
    if (gather_direct(x, segment.depth, branch, walk, surface, sum) && indirect_ && enter(walk)) {
      follow(transport().vertex(surface, walk), walk, branch, sum);
    }
    return sum;
  }

  bool indirect_;
};

}  // namespace

std::unique_ptr<Integrator> make_path_integrator(const Scene& scene,
                                                 const IntegratorSettings& settings) {
  return std::make_unique<PathIntegrator>(std::make_shared<const LitScene>(scene, settings),
                                          settings.name == "path");
}

}  // namespace psf::render
