// What counts as a medium between the surfaces, and what is told to whom it is in the way.
#include "analytic_support.h"
#include "core/error.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

// A floor, a medium, and a material for a volume of it that nothing has.
Scene with_unused_volume() {
  Scene scene;
  const int floor = add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.meshes.push_back(make_floor(floor, 10));
  Medium& mist = scene.media.emplace_back();
  mist.name = "mist";
  mist.sigma_s = grey(1);
  add_material(scene, MaterialKind::volume, 1);
  scene.materials.back().name = "fog";
  scene.materials.back().interior = 0;
  return scene;
}

std::vector<IntegratorSettings> without_volumes() {
  std::vector<IntegratorSettings> all(4);
  all[0].name = "vpl";
  all[1].name = "photon";
  all[2].photons = 8;
  all[3].vertices = 3;
  return all;
}

std::string refusal(const Scene& scene, const IntegratorSettings& settings) {
  try {
    static_cast<void>(make_integrator(scene, settings));
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("Volume: a material that no shape has is no volume") {
  Scene scene = with_unused_volume();
  Mesh unplaced = make_floor(1, 1);
  scene.prototypes.push_back(unplaced);
  for (const IntegratorSettings& settings : without_volumes()) {
    CAPTURE(settings.name, settings.photons, settings.vertices);
    CHECK(refusal(scene, settings).empty());
  }
  CHECK_FALSE(make(scene, "path")->has_volumes());
}

TEST_CASE("Volume: who knows no volumes names the option, the shape and its material") {
  std::vector<std::pair<Scene, std::string>> scenes;
  const auto add = [&](const std::string& what) -> Scene& {
    return scenes.emplace_back(with_unused_volume(), what).first;
  };
  add("the sphere \"puff\" of the material \"fog\", a volume")
      .spheres.push_back({"puff", Vec3(0, 2, 0), 1, 1});
  Mesh sheet = make_floor(1, 1);
  sheet.name = "sheet";
  add("the mesh \"sheet\" of the material \"fog\", a volume").meshes.push_back(sheet);
  Scene& placed = add("the mesh \"sheet\" of the material \"fog\", a volume");
  placed.prototypes.push_back(sheet);
  placed.instances.push_back({0, Mat4()});
  add("the medium \"mist\" everywhere").medium = 0;
  for (const auto& [scene, what] : scenes) {
    CHECK(make(scene, "path")->has_volumes());
    for (const IntegratorSettings& settings : without_volumes()) {
      const std::string said = refusal(scene, settings);
      const std::string option = settings.photons > 0    ? "`photons`"
                                 : settings.vertices > 0 ? "`vertices`"
                                                         : "integrator " + settings.name;
      CAPTURE(said, what, option);
      CHECK(said.find(what) != std::string::npos);
      CHECK(said.find(option) != std::string::npos);
      CHECK(said.find("take that out of the scene") != std::string::npos);
      CHECK(said.find('\n') == std::string::npos);
    }
  }
}
