// All light sources of a scene: finding them, their areas and their powers.
#include <fmt/format.h>

#include "render/light/frame.h"
#include "render/light/lights.h"

namespace psf::render {

namespace {

// Radians; a smaller sun is a point, as its radiance would overflow.
constexpr float kLeastAngle = 1e-5f;

const Texture* find_texture(const Scene& scene, int index) {
  return index == kNone ? nullptr : &scene.textures[static_cast<std::size_t>(index)];
}

// Luminance of the emission averaged over its texture.
float mean_luminance(const Rgb& emission, const Texture* texture) {
  if (texture == nullptr) return luminance(emission);
  double sum = 0;
  for (std::size_t y = 0; y < texture->height(); ++y) {
    for (std::size_t x = 0; x < texture->width(); ++x) {
      sum += double{luminance(texture->texel(x, y) * emission)};
    }
  }
  return static_cast<float>(sum / static_cast<double>(texture->width() * texture->height()));
}

const Material& material_of(const Scene& scene, int index) {
  return scene.materials[static_cast<std::size_t>(index)];
}

std::string name_or(const std::string& name, const char* kind, std::size_t index) {
  return name.empty() ? fmt::format("{} {}", kind, index) : name;
}

}  // namespace

Lights::Lights(const Scene& scene, Shapes& shapes, float radius, LightSampling sampling)
    : sky_(scene) {
  std::vector<float> powers;
  for (std::size_t l = 0; l < scene.lights.size(); ++l) {
    powers.push_back(add(scene.lights[l], radius));
    names_.push_back(name_or(scene.lights[l].name, "light", l));
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (is_black(material_of(scene, scene.meshes[m].material).emission)) continue;
    const float power = add(scene.meshes[m], scene);
    if (power < 0) continue;
    shapes.set_mesh_emitter(m, static_cast<int>(powers.size()));
    powers.push_back(power);
    names_.push_back(name_or(scene.meshes[m].name, "mesh", m));
  }
  for (std::size_t s = 0; s < scene.spheres.size(); ++s) {
    if (is_black(material_of(scene, scene.spheres[s].material).emission)) continue;
    shapes.set_sphere_emitter(s, static_cast<int>(powers.size()));
    powers.push_back(add(scene.spheres[s], scene));
    names_.push_back(name_or(scene.spheres[s].name, "sphere", s));
  }
  if (sky_.sampled()) powers.push_back(sky_.power() * kPi * radius * radius);
  choice_ = Distribution(powers);
  const bool many = count() > kEveryLight;
  if (sampling == LightSampling::tree || (sampling == LightSampling::automatic && many)) {
    place(powers, radius);
  }
  if (has_sky() && !sky_.sampled()) powers.push_back(sky_.power() * kPi * radius * radius);
  emission_ = Distribution(powers);
}

float Lights::add(const Light& light, float radius) {
  Record r;
  r.radiance = light.intensity;
  r.position = light.position;
  const float intensity = luminance(light.intensity);
  float power = 0;
  switch (light.kind) {
    case LightKind::point:
      r.kind = Kind::point;
      power = 4 * kPi * intensity;
      break;
    case LightKind::spot:
      r.kind = Kind::spot;
      r.direction = normalize(light.direction);
      r.cos_inner = light.cos_inner;
      r.cos_outer = light.cos_outer;
      power = 2 * kPi * (1 - 0.5f * (light.cos_inner + light.cos_outer)) * intensity;
      break;
    case LightKind::directional:
      r.kind = light.angle >= kLeastAngle ? Kind::sun : Kind::directional;
      r.direction = -normalize(light.direction);
      power = kPi * radius * radius * intensity;
      if (r.kind == Kind::sun) {
        const float half_sine = std::sin(0.5f * light.angle), sine = std::sin(light.angle);
        r.extent = 2 * half_sine * half_sine;
        r.radiance = light.intensity * (1 / (kPi * sine * sine));
        suns_.push_back(lights_.size());
      }
      break;
  }
  lights_.push_back(std::move(r));
  return power;
}

float Lights::add(const Mesh& mesh, const Scene& scene) {
  const Material& material = material_of(scene, mesh.material);
  std::vector<float> areas;
  areas.reserve(mesh.triangles.size());
  const std::size_t first = triangles_.size();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &p0 = mesh.positions[a], &p1 = mesh.positions[b], &p2 = mesh.positions[c];
    const TriangleNormal flat(p1 - p0, p2 - p0);
    areas.push_back(0.5f * flat.size);
    const float offset = std::max(max_abs(p0), std::max(max_abs(p1), max_abs(p2))) * kOffsetScale;
    triangles_.push_back(
        {p0, p1 - p0, p2 - p0, flat.size > 0 ? flat.normal : Vec3(0, 0, 1), offset});
  }
  Record r;
  r.kind = Kind::mesh;
  r.areas = Distribution(areas);
  if (!(r.areas.total() > 0)) {
    triangles_.resize(first);
    return -1;
  }
  r.radiance = material.emission;
  r.both_sides = material.emits_two_sided;
  r.texture = find_texture(scene, material.emission_texture);
  r.opacity = Opacity::of(material, scene);
  r.mesh = &mesh;
  r.first = first;
  const auto area = static_cast<float>(r.areas.total());
  r.extent = 1 / area;
  const float power =
      kPi * area * (r.both_sides ? 2.0f : 1.0f) * mean_luminance(r.radiance, r.texture);
  lights_.push_back(std::move(r));
  return power;
}

float Lights::add(const Sphere& sphere, const Scene& scene) {
  const Material& material = material_of(scene, sphere.material);
  Record r;
  r.kind = Kind::sphere;
  r.radiance = material.emission;
  r.both_sides = material.emits_two_sided;
  r.texture = find_texture(scene, material.emission_texture);
  r.opacity = Opacity::of(material, scene);
  r.position = sphere.center;
  r.extent = sphere.radius;
  if (!sphere.motion.empty()) r.sphere = &sphere;
  const float power = 4 * kPi * kPi * sphere.radius * sphere.radius * (r.both_sides ? 2.0f : 1.0f) *
                      mean_luminance(r.radiance, r.texture);
  lights_.push_back(std::move(r));
  return power;
}

std::vector<std::string> Lights::names() const {
  return names_;
}

}  // namespace psf::render
