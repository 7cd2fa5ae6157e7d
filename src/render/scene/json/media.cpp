// Media of the JSON scene file, and the names by which materials find them.
#include <algorithm>
#include <cmath>

#include "render/scene/json/parts.h"

namespace psf::render {
namespace {

constexpr Range kMeanCosine{-0.99, 0.99, "in [-0.99, 0.99]"};

// From 1 / world unit to the unit of the scene's space.
Rgb in_space_of(const Scene& scene, const Rgb& sigma) {
  const int exponent = scene.space.exponent;
  return {std::ldexp(sigma.x, exponent), std::ldexp(sigma.y, exponent),
          std::ldexp(sigma.z, exponent)};
}

// As absorption and scattering, or as what of the light is scattered and how far it goes before.
void read_coefficients(const JsonCursor& json, Medium& medium) {
  const auto albedo = json.find("albedo"), path = json.find("mean_free_path");
  const auto sigma_a = json.find("sigma_a"), sigma_s = json.find("sigma_s");
  if (!albedo && !path) {
    if (!sigma_a && !sigma_s) {
      json.fail("\"albedo\" and \"mean_free_path\" are missing, or \"sigma_a\" and \"sigma_s\"");
    }
    if (sigma_a) medium.sigma_a = sigma_a->rgb(kNonNegative);
    if (sigma_s) medium.sigma_s = sigma_s->rgb(kNonNegative);
    return;
  }
  if (sigma_a || sigma_s) {
    json.fail(
        "has \"albedo\" or \"mean_free_path\" and \"sigma_a\" or \"sigma_s\", one of both pairs is "
        "enough");
  }
  const Rgb scattered = json.at("albedo").rgb(kUnitRange);
  const Rgb length = json.at("mean_free_path").rgb(kPositive);
  for (int c = 0; c < 3; ++c) {
    medium.sigma_s[c] = scattered[c] / length[c];
    medium.sigma_a[c] = (1 - scattered[c]) / length[c];
  }
}

}  // namespace

void read_medium(const JsonCursor& json, Scene& scene) {
  json.check_keys({"name", "albedo", "mean_free_path", "sigma_a", "sigma_s", "g", "density"});
  Medium medium;
  const JsonCursor name = json.at("name");
  medium.name = name.text();
  for (const Medium& other : scene.media) {
    if (other.name == medium.name) name.fail("another medium is called \"" + medium.name + "\"");
  }
  read_coefficients(json, medium);
  medium.sigma_a = in_space_of(scene, medium.sigma_a);
  medium.sigma_s = in_space_of(scene, medium.sigma_s);
  if (const auto g = json.find("g")) medium.g = g->number(kMeanCosine);
  if (const auto density = json.find("density")) medium.density = read_density(*density, scene);
  scene.media.push_back(std::move(medium));
}

int read_medium_name(const JsonCursor& json, std::string_view key, const Scene& scene) {
  const JsonCursor cursor = json.at(key);
  const std::string name = cursor.text();
  const auto medium = std::find_if(scene.media.begin(), scene.media.end(),
                                   [&](const Medium& m) { return m.name == name; });
  if (medium == scene.media.end()) {
    std::vector<std::string_view> known;
    for (const Medium& m : scene.media) known.push_back(m.name);
    cursor.fail("no medium is called \"" + name + "\"" + suggestion(name, known));
  }
  return static_cast<int>(medium - scene.media.begin());
}

}  // namespace psf::render
