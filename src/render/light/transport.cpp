// What all integrators share: one step of a path at a time.
#include "render/light/transport.h"

#include <map>

#include "render/scene/volumes.h"

namespace psf::render {
namespace {

constexpr float kEndless = RayCaster::kEndless;
// A light through blended surfaces has its visibility bit where more than this share of it arrives.
constexpr float kSeen = 0.5f;

// As the trail has it: a rough lobe is the one that scatters most of the light this way.
std::uint8_t lobe_of(const Vertex& v, const BsdfSample& sample) {
  Lobe lobe = Lobe::perfect;
  if (sample.pdf > 0) {
    const Rgb share = v.bsdf.diffuse_share(v.local, sample.direction);
    lobe = luminance(share) >= 0.5f ? Lobe::diffuse : Lobe::glossy;
  }
  const bool transmitted = sample.direction.z * v.local.z < 0 && !v.bsdf.everywhere();
  return static_cast<std::uint8_t>(static_cast<int>(lobe) | (transmitted ? kTransmitted : 0));
}

}  // namespace

Transport::Transport(const Scene& scene, const IntegratorSettings& settings)
    : scene_(scene),
      settings_(settings),
      accel_(scene),
      shapes_(scene),
      caster_(scene, accel_, shapes_),
      lights_(scene, shapes_, accel_.radius(), settings.light_sampling),
      has_volumes_(!volume_in_use(scene).empty()),
      stands_(scene, accel_, shapes_, has_volumes_),
      coats_(scene.materials.size()),
      metals_(scene.materials.size()) {
  std::map<float, std::shared_ptr<const CoatAlbedo>> tables;
  std::shared_ptr<const CoatAlbedo> schlick, white;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const MaterialKind kind = scene.materials[m].kind;
    const bool gloss = kind == MaterialKind::gloss;
    const bool metal = scene.materials[m].multiple_scattering &&
                       (kind == MaterialKind::conductor ||
                        (kind == MaterialKind::coat && scene.materials[m].metalness > 0));
    if (gloss && schlick == nullptr) schlick = std::make_shared<CoatAlbedo>(CoatAlbedo::schlick());
    if (metal && white == nullptr) white = std::make_shared<CoatAlbedo>(CoatAlbedo::white());
    if (gloss) coats_[m] = schlick;
    if (metal) metals_[m] = white;
    if (kind != MaterialKind::coat) continue;
    if (scene.materials[m].clearcoat > 0 && clear_ == nullptr)
      clear_ = std::make_shared<CoatAlbedo>(Bsdf::kClearIor);
    auto& table = tables[scene.materials[m].ior];
    if (table == nullptr) table = std::make_shared<CoatAlbedo>(scene.materials[m].ior);
    coats_[m] = table;
  }
}

void Transport::begin(Walk& walk, std::uint64_t& rays) const {
  const Stand stand = stands_.at(walk.ray.origin, walk.ray.time, rays);
  walk.media = stand.media;
  walk.body = stand.body;
  walk.bodies = stand.bodies;
  if (walk.body == kNone) return;
  const float ior = scene_.materials[static_cast<std::size_t>(walk.body)].ior;
  walk.eta_scale = ior * ior;
  walk.throughput *= walk.eta_scale;
  if (walk.trail != nullptr) walk.trail->attenuate(Rgb(walk.eta_scale));
}

float Transport::next_surface(const Walk& walk, Surface& surface, Sampler& sampler,
                              std::uint64_t& rays) const {
  Hit hit;
  if (!meets(walk.ray, kEndless, sampler, hit, rays)) return kEndless;
  surface = shapes_.surface(hit, walk.ray.direction, walk.ray.time);
  if (walk.trail != nullptr) walk.trail->arrive(surface, walk.ray.direction, hit.distance);
  return hit.distance;
}

Vertex Transport::vertex(const Surface& surface, const Walk& walk) const {
  const Vec3 out = -walk.ray.direction;
  if (surface.medium != kNone) {
    const Medium& medium = scene_.media[static_cast<std::size_t>(surface.medium)];
    return {surface,   Bsdf::of_medium(medium, medium.albedo()), Frame(out), out, Vec3(0, 0, 1),
            walk.media};
  }
  const auto m = static_cast<std::size_t>(surface.material);
  const Frame frame(surface.normal);
  return {surface,
          Bsdf(scene_.materials[m], scene_, surface.uv, surface.front, coats_[m].get(),
               metals_[m].get(), clear_.get()),
          frame,
          out,
          frame.to_local(out),
          walk.media};
}

Rgb Transport::met(const Walk& walk, const Surface* surface, Tally& tally) const {
  if (surface != nullptr && surface->emitter == kNone) return {0, 0, 0};
  const Lights::Arrival arrival{walk.from, walk.ray.direction, walk.pdf, walk.sampled};
  if (surface == nullptr) {
    const Rgb sky = lights_.escaped(arrival, [&](std::size_t light, const Rgb& part) {
      tally.add(light, walk.throughput * part);
    });
    if (walk.trail != nullptr) walk.trail->meet(sky, true);
    return walk.throughput * sky;
  }
  const Rgb emission = lights_.emitted(arrival, *surface);
  if (walk.trail != nullptr) walk.trail->meet(emission, false);
  const Rgb radiance = walk.throughput * emission;
  tally.add(static_cast<std::size_t>(surface->emitter), radiance);
  return radiance;
}

Rgb Transport::direct(const Vertex& v, Lights::Sampled sampled, Sampler& sampler,
                      std::uint32_t& visibility, std::uint64_t& rays, Tally& tally,
                      const Rgb& throughput) const {
  if (v.bsdf.perfect()) return {0, 0, 0};
  std::uint32_t no_bit = 0;
  const auto sample = [&](std::size_t light, float expected, std::uint32_t& bits) {
    return direct_from(light, expected, v, sampler, bits, rays, tally, throughput);
  };
  Rgb sum(0, 0, 0);
  if (sampled == Lights::Sampled::every) {
    for (std::size_t light = 0; light < lights_.count(); ++light) {
      sum += sample(light, 1, visibility);
    }
    if (lights_.sky_sampled()) sum += sample(lights_.count(), 1, no_bit);
    return sum;
  }
  if (lights_.choices() == 0) return sum;
  const Receiver at = receiver_of(v);
  const float u = sampler.next_1d();
  float probability;
  if (sampled == Lights::Sampled::one) {
    const std::size_t light = lights_.choose(at, u, probability);
    return probability > 0 ? sample(light, probability, visibility) : sum;
  }
  // The one of the others comes first, so that its numbers are the same ones wherever it is.
  const PlacedChoice::Plan plan = lights_.placed().plan(at);
  const std::size_t other = lights_.placed().choose_rest(at, plan, u, probability);
  if (probability > 0) sum += sample(other, probability, no_bit);
  for (std::size_t k = 0; k < plan.count; ++k) sum += sample(plan.strong[k], 1, visibility);
  return sum;
}

Rgb Transport::direct_from(std::size_t light, float expected, const Vertex& v, Sampler& sampler,
                           std::uint32_t& visibility, std::uint64_t& rays, Tally& tally,
                           const Rgb& throughput) const {
  const Vec2 u = lights_.has_extent(light) ? sampler.next_2d() : Vec2(0, 0);
  LightSample sample;
  if (!lights_.sample(light, v.surface, receiver_of(v), u, sample)) return {0, 0, 0};
  const Vec3 local = v.frame.to_local(sample.direction);
  const bool in_front = local.z > 0 && dot(sample.direction, v.surface.geometric_normal) > 0;
  if (!in_front && !v.bsdf.everywhere()) return {0, 0, 0};

  Vec3 origin = v.surface.origin_toward(sample.direction);
  Rgb left(1, 1, 1);
  if (v.bodies > 0 && !leaves_body(v, sample, origin, left, sampler, rays)) return {0, 0, 0};
  const float seen = shines(origin, sample, v.surface.time, v.media, left, sampler, rays);
  if (!(seen > 0)) return {0, 0, 0};
  if (seen > kSeen && light < lights_.count()) visibility |= 1u << (light % Lights::kEveryLight);

  float scatter_pdf;
  const Rgb f = v.bsdf.evaluate(v.local, local, scatter_pdf);
  const float weight =
      sample.pdf > 0 ? mis_weight(sample.pdf * expected, scatter_pdf) / expected : 1 / expected;
  const Rgb radiance = f * sample.weight * (weight * seen) * left;
  if (tally.wants_diffuse()) tally.set_diffuse(v.bsdf.diffuse_share(v.local, local));
  tally.add(light, throughput * radiance);
  return radiance;
}

bool Transport::select_lobe(Vertex& v, Walk& walk, Sampler& sampler) const {
  const std::uint8_t smooth = v.bsdf.smooth_lobes(settings_.vertex_roughness);
  if (smooth != 0) {
    const float chance = v.bsdf.probability(smooth, v.local);
    const bool take_smooth = sampler.next_1d() < chance;
    v.bsdf.keep(static_cast<std::uint8_t>(take_smooth ? smooth : v.bsdf.lobes() & ~smooth));
    const float counts = 1 / (take_smooth ? chance : 1 - chance);
    walk.throughput *= counts;
    if (walk.trail != nullptr) walk.trail->scale(counts);
  }
  return !v.bsdf.perfect() && v.bsdf.roughness() >= settings_.vertex_roughness;
}

bool Transport::sample_scattering(const Vertex& v, Sampler& sampler, BsdfSample& sample,
                                  Vec3& direction, float& correction) {
  const Vec2 u = v.bsdf.perfect() ? Vec2(0, 0) : sampler.next_2d();
  const float choice = v.bsdf.chooses() ? sampler.next_1d() : 0.0f;
  if (!v.bsdf.sample(v.local, u, choice, sample)) return false;
  direction = v.frame.to_world(sample.direction);
  correction = flux_correction(v, direction);
  // Where an interpolated normal sends the path through the surface that it should leave (or the
  // other way): a perfect lobe takes the geometric normal, which has no such trouble; other lobes
  // absorb.
  const bool reflected = sample.direction.z > 0;
  if ((dot(direction, v.surface.geometric_normal) > 0) != reflected) {
    if (sample.pdf > 0) return false;
    const Frame flat(v.surface.geometric_normal);
    if (!v.bsdf.sample(flat.to_local(v.out), u, choice, sample)) return false;
    direction = flat.to_world(sample.direction);
    correction = 1;
  }
  return true;
}

bool Transport::go_on(const Vertex& v, const BsdfSample& sample, const Vec3& direction,
                      Walk& walk) {
  if (is_black(walk.throughput)) return false;
  // What met nothing on the way is still on that from the last vertex.
  if (!sample.straight) {
    walk.pdf = sample.pdf;
    walk.from = receiver_of(v);
  }
  const bool inside = sample.inside || v.bodies > 0;
  if (inside && walk.body == kNone) {
    walk.bodies = 1;
    walk.within = Rgb(1, 1, 1);
    walk.events = 0;
  }
  walk.body = inside ? v.surface.material : kNone;
  walk.ray = {v.surface.origin_toward(direction), normalize(direction), v.surface.time};
  // Glass has no medium in it.
  if (v.bsdf.is_glass() && sample.direction.z < 0) {
    v.surface.front ? walk.media.enter(kNone) : walk.media.leave();
  }
  return true;
}

bool Transport::scatter(const Vertex& v, Walk& walk, Sampler& sampler) const {
  if (walk.trail != nullptr) tell(v, walk);
  BsdfSample sample;
  Vec3 direction;
  float correction;
  if (!sample_scattering(v, sampler, sample, direction, correction)) return false;
  walk.throughput = walk.throughput * sample.weight;
  walk.eta_scale *= sample.eta_scale;
  if (!go_on(v, sample, direction, walk)) return false;
  if (walk.trail != nullptr) {
    walk.trail->leave(walk.ray.direction, sample.pdf > 0 ? sample.pdf : kEndless, sample.weight,
                      lobe_of(v, sample));
  }
  return true;
}

void Transport::tell(const Vertex& v, const Walk& walk) {
  walk.trail->scatters(v.bsdf.albedo(), v.bsdf.perfect() ? 0 : v.bsdf.least_roughness());
}

bool Transport::scatter_power(const Vertex& v, Walk& walk, Sampler& sampler) const {
  BsdfSample sample;
  Vec3 direction;
  float correction;
  if (!sample_scattering(v, sampler, sample, direction, correction)) return false;
  // Power, unlike radiance, does not change with the density of the medium.
  walk.throughput = walk.throughput * sample.weight * (correction / sample.eta_scale);
  return go_on(v, sample, direction, walk);
}

bool Transport::survives(Walk& walk, Sampler& sampler) const {
  if (walk.depth < settings_.roulette_depth) return true;
  const float q = max_component(walk.throughput) / walk.eta_scale;
  if (q >= 1) return true;
  const bool survived = sampler.next_1d() < q;
  if (walk.trail != nullptr) survived ? walk.trail->survive(1 / q) : walk.trail->end();
  if (survived) walk.throughput *= 1 / q;
  return survived;
}

void Transport::record_vertex(const Vertex& v, const Walk& walk, PathRecord& record) const {
  record.has_vertex = true;
  record.position = v.surface.position;
  const bool in_volume = v.surface.medium != kNone;
  record.rest = v.surface.rest;
  record.normal = in_volume ? Vec3(0, 0, 0) : v.surface.normal;
  record.reflectance = v.bsdf.albedo();
  record.throughput = walk.throughput;
  record.direction = v.out;
  record.material = static_cast<std::uint32_t>(v.surface.material);
  record.roughness = v.bsdf.least_roughness();
  if (v.surface.on_curve) record.kind = VertexKind::curve;
  if (in_volume) record.kind = VertexKind::volume;
  if (walk.trail == nullptr) return;
  tell(v, walk);
  walk.trail->select();
}

}  // namespace psf::render
