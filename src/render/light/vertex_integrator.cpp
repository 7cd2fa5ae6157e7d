// From the camera to x_i, and the steps behind it that several integrators take.
#include "render/light/vertex_integrator.h"

#include "core/interrupt.h"

namespace psf::render {

std::string VertexIntegrator::visibility_rule() const {
  switch (lit_->transport.lights().at_vertex()) {
    case Lights::Sampled::every:
      break;
    case Lights::Sampled::one:
      return "of one light, chosen at random by power";
    case Lights::Sampled::strong:
      return "of each light that is likely to bring at least an eighth of the light at x_i, by its "
             "power, distance and direction alone";
  }
  return {};
}

PathRecord VertexIntegrator::trace(const Ray& camera_ray, Sampler& sampler, bool shade,
                                   std::uint64_t& rays, const PathDetails& details) const {
  const Transport& transport = lit_->transport;
  PathRecord record;
  Walk walk;
  walk.ray = camera_ray;
  walk.from.position = camera_ray.origin;
  walk.trail = details.trail;
  transport.begin(walk, rays);
  Tally seen = Tally::of_camera(lit_->plan, details.layers);
  std::uint32_t no_bits = 0;
  if (walk.body != kNone && !leave_body(walk, sampler, rays, seen, record)) return record;
  for (;;) {
    Surface surface;
    const float distance = transport.arrive(walk, surface, sampler, rays);
    if (std::isinf(distance)) {
      record.unfiltered += transport.met(walk, nullptr, seen);
      return record;
    }
    record.coverage = 1;
    record.distance += distance;
    record.unfiltered += transport.met(walk, &surface, seen);
    if (!enter(walk)) return record;
    Vertex v = transport.vertex(surface, walk);
    if (v.bsdf.black()) return record;
    if (transport.select_lobe(v, walk, sampler)) {
      transport.record_vertex(v, walk, record);
      if (shade) {
        shade_vertex(v, walk, sampler, rays, details, record);
        return record;
      }
      // Whom it may be averaged with must be known: the same shadow rays, and nothing else.
      Tally none;
      static_cast<void>(transport.direct(v, transport.lights().at_vertex(), sampler,
                                         record.visibility, rays, none, walk.throughput));
      record.hit_distance = std::numeric_limits<float>::quiet_NaN();
      return record;
    }
    const Rgb direct =
        transport.direct(v, Lights::Sampled::one, sampler, no_bits, rays, seen, walk.throughput);
    record.unfiltered += walk.throughput * direct;
    if (walk.trail != nullptr) walk.trail->add_direct(direct);
    walk.sampled = Lights::Sampled::one;
    if (!transport.scatter(v, walk, sampler) || !transport.survives(walk, sampler)) return record;
  }
}

bool VertexIntegrator::leave_body(Walk& walk, Sampler& sampler, std::uint64_t& rays,
                                  const Tally& seen, PathRecord& record) const {
  std::uint32_t no_bits = 0;
  float no_distance;
  Branch branch{sampler, no_bits, no_distance, rays, seen, walk.trail};
  const Vec3 eye = walk.ray.origin;
  record.coverage = 1;
  if (!pass_body(walk, branch, record.unfiltered)) return false;
  record.distance = std::sqrt(length_sq(walk.ray.origin - eye));
  return true;
}

void VertexIntegrator::shade_vertex(const Vertex& x, const Walk& walk, Sampler& sampler,
                                    std::uint64_t& rays, const PathDetails& details,
                                    PathRecord& record) const {
  record.shaded = true;
  const std::uint32_t split = transport().settings().split;
  const Sampler here = sampler;
  const Segment segment{walk.depth, record.distance};
  const auto tally = [&] { return Tally::of_vertex(lit_->plan, details.layers); };
  if (split <= 1) {
    Branch branch{sampler, record.visibility, record.hit_distance, rays, tally(), details.trail};
    record.contribution = gather(x, segment, branch);
  } else {
    std::uint32_t no_bits = 0;
    float no_distance;
    for (std::uint32_t k = 0; k < split && !core::overdue(); ++k) {
      Sampler continued = sampler.split(k, split);
      Branch branch{continued, k == 0 ? record.visibility : no_bits,
                    k == 0 ? record.hit_distance : no_distance, rays, tally()};
      record.contribution += gather(x, segment, branch);
    }
    record.contribution *= 1 / static_cast<float>(split);
    for (Rgb& layer : details.layers.contribution) layer *= 1 / static_cast<float>(split);
  }
  Tally once = tally();
  record.contribution += gather_once(x, segment, here, rays, once);
}

Rgb VertexIntegrator::gather_once(const Vertex&, const Segment&, const Sampler&, std::uint64_t&,
                                  Tally&) const {
  return {0, 0, 0};
}

bool VertexIntegrator::gather_direct(const Vertex& x, int depth, Branch& branch, Walk& walk,
                                     Surface& surface, Rgb& sum) const {
  const Transport& transport = lit_->transport;
  const Lights::Sampled sampled = transport.lights().at_vertex();
  sum = transport.direct(x, sampled, branch.sampler, branch.visibility, branch.rays, branch.tally,
                         Rgb(1, 1, 1));
  if (branch.trail != nullptr) branch.trail->add_direct(sum);
  walk.trail = branch.trail;
  walk.media = x.media;
  branch.hit_distance = std::numeric_limits<float>::infinity();
  walk.depth = depth;
  walk.sampled = sampled;
  if (!transport.scatter(x, walk, branch.sampler)) return false;
  if (branch.tally.wants_diffuse()) {
    branch.tally.set_diffuse(
        walk.body != kNone ? Rgb(1, 1, 1)
        : walk.pdf > 0     ? x.bsdf.diffuse_share(x.local, x.frame.to_local(walk.ray.direction))
                           : Rgb(0, 0, 0));
  }
  branch.tally.leave_vertex();
  if (!pass_body(walk, branch, sum)) return false;
  branch.hit_distance = transport.arrive(walk, surface, branch.sampler, branch.rays);
  const bool escaped = std::isinf(branch.hit_distance);
  sum += transport.met(walk, escaped ? nullptr : &surface, branch.tally);
  branch.tally.bounce();
  return !escaped;
}

bool VertexIntegrator::pass_body(Walk& walk, Branch& branch, Rgb& sum) const {
  const Transport& transport = lit_->transport;
  std::uint32_t no_bits = 0;
  while (walk.body != kNone) {
    walk.passed = true;
    const std::optional<Vertex> v = transport.next_inside(walk, branch.sampler, branch.rays);
    if (!v) return false;
    const Rgb direct = transport.direct(*v, Lights::Sampled::one, branch.sampler, no_bits,
                                        branch.rays, branch.tally, walk.throughput);
    sum += walk.throughput * direct;
    if (walk.trail != nullptr) walk.trail->add_direct(direct);
    walk.sampled = Lights::Sampled::one;
    if (!transport.scatter(*v, walk, branch.sampler)) return false;
  }
  return true;
}

bool VertexIntegrator::enter(Walk& walk) const {
  if (walk.depth >= transport().settings().max_depth) return false;
  ++walk.depth;
  return true;
}

void VertexIntegrator::follow(Vertex v, Walk& walk, Branch& branch, Rgb& sum) const {
  const Transport& transport = lit_->transport;
  std::uint32_t no_bits = 0;
  while (!v.bsdf.black()) {
    if (v.bsdf.evaluates()) {
      const Rgb direct = transport.direct(v, Lights::Sampled::one, branch.sampler, no_bits,
                                          branch.rays, branch.tally, walk.throughput);
      sum += walk.throughput * direct;
      if (walk.trail != nullptr) walk.trail->add_direct(direct);
    }
    walk.sampled = Lights::Sampled::one;
    if (!transport.scatter(v, walk, branch.sampler)) return;
    if (!pass_body(walk, branch, sum)) return;
    if (!transport.survives(walk, branch.sampler)) return;
    Surface surface;
    const bool escaped = std::isinf(transport.arrive(walk, surface, branch.sampler, branch.rays));
    sum += transport.met(walk, escaped ? nullptr : &surface, branch.tally);
    if (escaped || !enter(walk)) return;
    v = transport.vertex(surface, walk);
  }
}

}  // namespace psf::render
