// All light sources of a scene: where light leaves them, and which way.
#include "render/light/frame.h"
#include "render/light/lights.h"

namespace psf::render {

bool Lights::emit(const Vec3& center, float radius, float choice, const Vec2& where,
                  const Vec2& whither, Emission& emission) const {
  if (!(emission_.total() > 0)) return false;
  const std::size_t light = emission_.sample(choice);
  emission.light = light;
  const Record* r = light < count() ? &lights_[light] : nullptr;
  if (r == nullptr || r->kind == Kind::directional || r->kind == Kind::sun) {
    emit_far(r, center, radius, where, whither, emission);
  } else if (r->kind == Kind::mesh) {
    emit_mesh(*r, choice, where, whither, emission);
  } else if (r->kind == Kind::sphere) {
    emit_sphere(*r, choice, where, whither, emission);
  } else {
    emit_point(*r, whither, emission);
  }
  emission.power *= 1 / emission_.probability(light);
  return !is_black(emission.power);
}

void Lights::emit_mesh(const Record& light, float choice, Vec2 where, const Vec2& whither,
                       Emission& emission) const {
  const std::size_t k = light.areas.sample(where.x);
  const Triangle& triangle = triangles_[light.first + k];
  const float root = std::sqrt(where.x), b1 = root * (1 - where.y), b2 = root * where.y;
  const float side = light.both_sides && choice < 0.5f ? -1.0f : 1.0f;
  const Vec3 normal = triangle.normal * side;
  emission.origin =
      triangle.corner + triangle.edge1 * b1 + triangle.edge2 * b2 + normal * triangle.offset;
  emission.direction = normalize(Frame(normal).to_world(cosine_hemisphere(whither)));
  emission.power = mean_radiance(light, texture_point(light, k, b1, b2)) *
                   (kPi * (light.both_sides ? 2.0f : 1.0f) / light.extent);
}

void Lights::emit_sphere(const Record& light, float choice, const Vec2& where, const Vec2& whither,
                         Emission& emission) {
  const Vec3 outward = uniform_sphere(where);
  const float side = light.both_sides && choice < 0.5f ? -1.0f : 1.0f;
  const float offset = (max_abs(light.position) + light.extent) * kOffsetScale;
  emission.origin = light.position + outward * (light.extent + side * offset);
  emission.direction = normalize(Frame(outward * side).to_world(cosine_hemisphere(whither)));
  const float area = 4 * kPi * light.extent * light.extent;
  emission.power = mean_radiance(light, direction_to_uv(outward)) *
                   (kPi * area * (light.both_sides ? 2.0f : 1.0f));
}

void Lights::emit_point(const Record& light, const Vec2& whither, Emission& emission) {
  emission.origin = light.position;
  if (light.kind == Kind::point) {
    emission.direction = uniform_sphere(whither);
    emission.power = light.radiance * (4 * kPi);
    return;
  }
  const Vec3 local = uniform_cone(whither, 1 - light.cos_outer);
  emission.direction = normalize(Frame(light.direction).to_world(local));
  emission.power = light.radiance * (2 * kPi * (1 - light.cos_outer) * spot_share(light, local.z));
}

void Lights::emit_far(const Record* light, const Vec3& center, float radius, const Vec2& where,
                      const Vec2& whither, Emission& emission) const {
  Vec3 toward;
  Rgb irradiance;  // on a facing surface, over the density of this direction
  if (light == nullptr) {
    float pdf;
    toward = sky_.sample(whither, pdf);
    irradiance = pdf > 0 ? sky_.radiance(toward) * (1 / pdf) : Rgb(0, 0, 0);
  } else if (light->kind == Kind::sun) {
    toward = normalize(Frame(light->direction).to_world(uniform_cone(whither, light->extent)));
    irradiance = light->radiance * (1 / cone_pdf(light->extent));
  } else {
    toward = light->direction;
    irradiance = light->radiance;
  }
  const Vec3 on_disk = Frame(toward).to_world(around_axis(where.x, where.y, 0));
  // Twice as far away as need be, so that the ray starts outside whatever rounding does.
  emission.origin = center + (on_disk + toward * 2) * radius;
  emission.direction = -toward;
  emission.power = irradiance * (kPi * radius * radius);
}

}  // namespace psf::render
