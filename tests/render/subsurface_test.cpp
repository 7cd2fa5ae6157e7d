// Bodies that are filled with a medium: what they reflect against closed forms, energy, reciprocity.
#include <vector>

#include "body_scenes.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

// A block so wide and deep that light of its middle does not find another side; its top is y = 0.
// No wider than need be: rays start 2^-19 of its size off the surface.
Scene half_space(const Body& body) {
  Scene scene;
  const int material = add_body(scene, body);
  const float r = body.albedo > 0.98f ? 400 : 60;
  const Vec3 x(2 * r, 0, 0), y(0, 2 * r, 0), z(0, 0, 2 * r), low(-r, -2 * r, -r), high(r, 0, r);
  for (const Mesh& side :
       {quad(low, x, z, material), quad(high, -z, -x, material), quad(low, z, y, material),
        quad(high, -y, -z, material), quad(low, y, x, material), quad(high, -x, -y, material)}) {
    scene.meshes.push_back(side);
  }
  return scene;
}

void add_sky(Scene& scene) {
  scene.environment.radiance = grey(1);
}

// The same light as a sphere around everything, which is sampled.
void add_shell(Scene& scene) {
  const int material = add_material(scene, MaterialKind::diffuse, 0, 1);
  scene.materials.back().emits_two_sided = true;
  scene.spheres.push_back({"", Vec3(0, 0, 0), 8000, material});
}

// A ray that meets the origin from above at this cosine.
Ray from_above(float cosine, float phi = 0) {
  const float sine = std::sqrt(1 - cosine * cosine);
  return ray(Vec3(sine * std::cos(phi), cosine, sine * std::sin(phi)) * 3, {0, 0, 0});
}

// Chandrasekhar's H function for isotropic scattering, by iterating 1 / H(mu) = sqrt(1 - albedo) +
// albedo / 2 integral of t H(t) / (mu + t) over t from 0 to 1.
class HFunction {
 public:
  explicit HFunction(double albedo) : albedo_(albedo), values_(kNodes, 1) {
    for (int k = 0; k < 400; ++k) {
      std::vector<double> next(kNodes);
      for (std::size_t i = 0; i < kNodes; ++i) next[i] = (values_[i] + (*this)(node(i))) / 2;
      values_ = next;
    }
  }
  [[nodiscard]] double operator()(double mu) const {
    double sum = 0;
    for (std::size_t i = 0; i < kNodes; ++i) sum += node(i) * values_[i] / (mu + node(i));
    return 1 / (std::sqrt(1 - albedo_) + albedo_ / 2 * sum / kNodes);
  }
  // What the half-space reflects of a beam at cosine mu, or toward mu of a uniform sky.
  [[nodiscard]] double plane_albedo(double mu) const {
    return 1 - (*this)(mu)*std::sqrt(1 - albedo_);
  }

 private:
  static constexpr std::size_t kNodes = 128;
  static double node(std::size_t i) { return (static_cast<double>(i) + 0.5) / kNodes; }
  double albedo_;
  std::vector<double> values_;
};

// Within three standard errors, which are at most `precision` of what is expected.
void check_near(const Estimate& e, double expected, double precision) {
  CAPTURE(e.mean, e.error, expected);
  CHECK(e.error <= precision * expected);
  CHECK(std::abs(e.mean - expected) <= 3 * e.error + 1e-4 * expected);
}

}  // namespace

TEST_CASE("Subsurface: a half-space reflects what Chandrasekhar's H function says") {
  for (const float albedo : {0.1f, 0.5f, 0.9f, 0.99f, 0.999f}) {
    Scene scene = half_space({.albedo = albedo});
    add_sky(scene);
    const auto integrator = make(scene, "path", 1);  // the depth does not count inside
    const HFunction h(double{albedo});
    for (const float mu : {1.0f, 0.5f, 0.15f}) {
      CAPTURE(albedo, mu);
      const std::uint64_t paths = albedo < 0.3f ? 2048 : albedo < 0.7f ? 512 : 128;
      check_near(estimate(*integrator, from_above(mu), SamplerKind::sobol, paths),
                 h.plane_albedo(double{mu}), 0.015);
    }
  }
}

TEST_CASE("Subsurface: light that is sampled through the boundary is what scattering finds") {
  const HFunction h(0.8);
  Scene matched = half_space({.albedo = 0.8f});
  add_shell(matched);
  check_near(estimate(*make(matched, "path"), from_above(0.6f), SamplerKind::sobol, 256),
             h.plane_albedo(0.6), 0.02);
  for (const float roughness : {0.3f, 0.7f}) {
    CAPTURE(roughness);
    const Body body{.albedo = 0.9f, .ior = 1.4f, .roughness = roughness, .g = 0.4f};
    Scene sky = half_space(body), shell = half_space(body);
    add_sky(sky);
    add_shell(shell);
    const Estimate a = estimate(*make(sky, "path"), from_above(0.7f), SamplerKind::sobol, 256);
    const Estimate b = estimate(*make(shell, "path"), from_above(0.7f), SamplerKind::sobol, 256);
    CAPTURE(a.mean, a.error, b.mean, b.error);
    CHECK(std::hypot(a.error, b.error) < 0.02 * a.mean);
    CHECK(std::abs(a.mean - b.mean) < 3 * std::hypot(a.error, b.error));
  }
}

TEST_CASE("Subsurface: a half-space turns a beam into the directions of Chandrasekhar's solution") {
  const HFunction h(0.9);
  Scene scene = half_space({.albedo = 0.9f});
  const double mu0 = 0.8;
  Light sun;
  sun.kind = LightKind::directional;
  sun.direction = Vec3(0.6f, -0.8f, 0);
  scene.lights.push_back(sun);
  const auto integrator = make(scene, "path");
  for (const float mu : {0.9f, 0.4f}) {
    CAPTURE(mu);
    const double m = double{mu};
    check_near(estimate(*integrator, from_above(mu, 1), SamplerKind::sobol, 512),
               0.9 / (4 * kPiD) * mu0 / (m + mu0) * h(m) * h(mu0), 0.015);
  }
}

TEST_CASE("Subsurface: light goes both ways alike") {
  for (const Body& body : {Body{.albedo = 0.9f, .g = 0.6f},
                           Body{.albedo = 0.9f, .ior = 1.4f, .roughness = 0.6f, .g = -0.3f}}) {
    CAPTURE(body.ior);
    const float cosines[] = {0.9f, 0.3f};
    Estimate found[2];
    for (int way = 0; way < 2; ++way) {
      Scene scene = half_space(body);
      Light sun;
      sun.kind = LightKind::directional;
      const float in = cosines[way];
      sun.direction = Vec3(0, -in, std::sqrt(1 - in * in));
      scene.lights.push_back(sun);
      found[way] = estimate(*make(scene, "path"), from_above(cosines[1 - way]), SamplerKind::sobol,
                            body.ior > 1 ? 4096 : 512);
      found[way].mean /= double{in};
      found[way].error /= double{in};
    }
    CAPTURE(found[0].mean, found[1].mean, found[0].error, found[1].error);
    const double error = std::hypot(found[0].error, found[1].error);
    CHECK(error < 0.03 * found[0].mean);
    CHECK(std::abs(found[0].mean - found[1].mean) < 3 * error);
  }
}

TEST_CASE("Subsurface: a furnace, where nothing is absorbed") {
  for (const Body& body : {Body{.g = 0.7f, .sigma_t = 3}, Body{.ior = 1.5f, .sigma_t = 3},
                           Body{.ior = 1.3f, .g = -0.5f, .sigma_t = 20}}) {
    Scene scene;
    const int material = add_body(scene, body);
    scene.spheres.push_back({"", Vec3(0, 0, 0), 1, material});
    // Overlapping bodies of a medium are one.
    scene.spheres.push_back({"", Vec3(0.7f, 0.3f, 0), 0.6f, material});
    add_sky(scene);
    CAPTURE(body.ior, body.g);
    for (const char* name : {"path", "vpl", "photon"}) {
      CAPTURE(name);
      const auto integrator = make(scene, name, 64);
      for (const Vec3& target : {Vec3(0, 0, 0), Vec3(0, 0.9f, 0), Vec3(0.9f, 0.4f, 0)}) {
        const Ray r = ray({0, 0.2f, 5}, target);
        check(estimate(*integrator, r, SamplerKind::sobol, 64, 8), 1);
      }
    }
  }
}

TEST_CASE("Subsurface: a rough boundary loses what would bounce between microfacets, and no more") {
  for (const float roughness : {0.15f, 0.4f, 1.0f}) {
    Scene scene;
    const int material = add_body(scene, {.ior = 1.4f, .roughness = roughness, .sigma_t = 3});
    scene.spheres.push_back({"", Vec3(0, 0, 0), 1, material});
    add_sky(scene);
    const Estimate e =
        estimate(*make(scene, "path"), ray({0, 0.2f, 5}, {0, 0.5f, 0}), SamplerKind::sobol, 256, 8);
    CAPTURE(roughness, e.mean, e.error);
    CHECK(e.mean < 1.0005 + 3 * e.error);
    CHECK(e.mean > (roughness < 0.2f ? 0.97 : roughness < 0.5f ? 0.85 : 0.35));
  }
}

TEST_CASE("Subsurface: channels that differ keep the mean of each") {
  Scene scene = half_space({});
  scene.media[0].sigma_s = Rgb(0.5f, 1.8f, 4);
  scene.media[0].sigma_a = Rgb(0.5f, 0.2f, 0.1f);
  add_sky(scene);
  const auto integrator = make(scene, "path");
  for (int c = 0; c < 3; ++c) {
    const double s = double{scene.media[0].sigma_s[c]};
    const double albedo = s / (s + double{scene.media[0].sigma_a[c]});
    const Estimate e = batches(32, [&](std::uint32_t b) {
      double sum = 0;
      for (std::uint64_t i = 0; i < 512; ++i) {
        sum += double{pixel(trace(*integrator, from_above(0.5f), SamplerKind::sobol, b, i))[c]};
      }
      return sum / 512;
    });
    CAPTURE(c);
    check_near(e, HFunction(albedo).plane_albedo(0.5), 0.02);
  }
}

TEST_CASE("Subsurface: the vertex is where the path comes in") {
  for (const float ior : {1.0f, 1.5f}) {
    Scene scene = half_space({.albedo = 0.99f, .ior = ior});
    add_sky(scene);
    const auto integrator = make(scene, "path");
    int entered = 0;
    for (std::uint64_t i = 0; i < 64; ++i) {
      const PathRecord r = trace(*integrator, from_above(0.5f), SamplerKind::sobol, 0, i);
      if (!r.has_vertex) {  // the sky, seen in the smooth boundary
        CHECK(ior > 1);
        CHECK(r.unfiltered.y > 0);
        continue;
      }
      ++entered;
      CHECK(length_sq(r.position) < 1e-6f);
      CHECK(r.normal.y > 0.999f);
      CHECK(r.kind == VertexKind::surface);
      CHECK(r.unfiltered.y == 0);
      CHECK(r.roughness == 1);
      CHECK(r.reflectance.y > 0.5f);
      CHECK(r.reflectance.y < 0.99f);
    }
    CHECK(entered > 32);
    CHECK((entered == 64) == (ior == 1));
  }
}

TEST_CASE("Subsurface: a surface that is not closed, and what is in a body, end the walk") {
  Scene open;
  const int material = add_body(open, {.sigma_t = 5});
  open.meshes.push_back(make_floor(material, 1));
  add_sky(open);
  const auto integrator = make(open, "path");
  double sum = 0;
  for (std::uint64_t i = 0; i < 64; ++i) {
    sum += double{pixel(trace(*integrator, from_above(0.7f), SamplerKind::sobol, 0, i)).y};
  }
  CHECK(sum < 64);

  Scene filled;
  const int wax = add_body(filled, {.sigma_t = 0.1f});
  const int stone = add_material(filled, MaterialKind::diffuse, 1);
  filled.spheres = {{"", Vec3(0, 0, 0), 1, wax}, {"", Vec3(0, 0, 0), 0.98f, stone}};
  add_sky(filled);
  const Estimate e =
      estimate(*make(filled, "path"), ray({0, 0, 5}, {0, 0, 0}), SamplerKind::sobol, 64, 4);
  CHECK(e.mean < 0.05);
}
