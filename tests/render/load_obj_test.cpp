// OBJ and MTL: what becomes of faces and materials, and what is refused.
#include "catch.h"
#include "load_support.h"

namespace psf::render {
namespace {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Failure obj_failure(const std::string& text) {
  const TempFolder folder;
  return load_failure(folder.write("s.obj", text));
}

const Material& material_called(const Scene& scene, const std::string& name) {
  for (const Material& material : scene.materials) {
    if (material.name == name) return material;
  }
  FAIL("no material " << name);
  return scene.materials[0];
}

TEST_CASE("faces are split by material, and share vertices within", "[load][obj]") {
  const TempFolder folder;
  folder.write("s.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  const Scene scene = load_scene(folder.write(
      "s.obj", "mtllib s.mtl\no wall\n" + kSquare +
                   "v 2 0 0\nv 2 1 0\nusemtl red\nf 1 2 3 4\nusemtl blue\nf 2 5 6\nf 2 6 3\n"));
  REQUIRE(scene.meshes.size() == 2);
  CHECK(scene.meshes[0].name == "wall/red");
  CHECK(scene.meshes[0].triangles.size() == 2);
  CHECK(scene.meshes[0].positions.size() == 4);
  CHECK(scene.meshes[0].normals.empty());
  CHECK(scene.meshes[0].uvs.empty());
  CHECK(scene.meshes[1].name == "wall/blue");
  CHECK(scene.meshes[1].positions.size() == 4);
  CHECK(scene.materials.size() == 2);
  CHECK(scene.materials[0].two_sided);
}

TEST_CASE("normals, texture coordinates and negative indices arrive", "[load][obj]") {
  const TempFolder folder;
  const Scene scene = load_scene(folder.write("s.obj",
                                              "v 0 0 0\nv 1 0 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 0 "
                                              "1\nvn 0 0 2\nf -3/-3/-1 -2/-2/-1 -1/-1/-1\n"));
  const Mesh& mesh = scene.meshes.at(0);
  CHECK(mesh.positions[2] == Vec3(0, 2, 0));
  CHECK(mesh.uvs[1] == Vec2(1, 0));
  CHECK(mesh.normals[0] == Vec3(0, 0, 1));
  CHECK(scene.materials.at(0).name == "default");
}

TEST_CASE("MTL maps to our materials as documented", "[load][obj]") {
  const TempFolder folder;
  folder.write("s.mtl",
               "newmtl plain\nillum 1\nKd 0.1 0.2 0.3\nKs 1 1 1\n"
               "newmtl lamp\nKd 0 0 0\nKe 5 6 7\n"
               "newmtl shiny\nillum 2\nKd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 30\nNi 1.4\n"
               "newmtl metal\nillum 2\nKd 0 0 0\nKs 0.9 0.7 0.5\nNs 126\n"
               "newmtl mirror\nillum 3\nKd 0 0 0\nKs 0.8 0.8 0.8\n"
               "newmtl glass\nillum 7\nKd 1 1 1\nNi 1.33\n"
               "newmtl clear\nd 0.1\nKd 1 1 1\n"
               "newmtl pbr\nKd 0.4 0.4 0.4\nPr 0.25\nPm 0.75\n");
  std::string obj = "mtllib s.mtl\n" + kSquare;
  for (const char* name : {"plain", "lamp", "shiny", "metal", "mirror", "glass", "clear", "pbr"}) {
    obj += std::string("usemtl ") + name + "\nf 1 2 3\n";
  }
  const Scene scene = load_scene(folder.write("s.obj", obj));
  CHECK(material_called(scene, "plain").kind == MaterialKind::diffuse);
  CHECK(material_called(scene, "plain").reflectance == Rgb(0.1f, 0.2f, 0.3f));
  CHECK(material_called(scene, "lamp").emission == Rgb(5, 6, 7));
  CHECK(material_called(scene, "shiny").kind == MaterialKind::coat);
  // Ns 30: alpha^2 = 2 / 32, so alpha = 1/4 and the perceptual roughness 1/2.
  CHECK(material_called(scene, "shiny").roughness == Approx(0.5));
  CHECK(material_called(scene, "shiny").ior == Approx(1.4));
  CHECK(material_called(scene, "metal").kind == MaterialKind::conductor);
  CHECK(material_called(scene, "metal").reflectance == Rgb(0.9f, 0.7f, 0.5f));
  CHECK(material_called(scene, "metal").roughness == Approx(0.35355).epsilon(1e-4));
  CHECK(material_called(scene, "mirror").kind == MaterialKind::mirror);
  CHECK(material_called(scene, "mirror").reflectance == Rgb(0.8f));
  CHECK(material_called(scene, "glass").kind == MaterialKind::glass);
  CHECK(material_called(scene, "glass").ior == Approx(1.33));
  CHECK(material_called(scene, "glass").reflectance == Rgb(1));
  CHECK(material_called(scene, "clear").kind == MaterialKind::glass);
  CHECK(material_called(scene, "pbr").kind == MaterialKind::coat);
  CHECK(material_called(scene, "pbr").roughness == 0.25f);
  CHECK(material_called(scene, "pbr").metalness == 0.75f);
}

TEST_CASE("textures are found beside the MTL, with backslashes and another case too",
          "[load][obj]") {
  const TempFolder folder;
  folder.write("Textures/Wood.PPM", ppm(1, "255 0 0"));
  folder.write("s.mtl",
               "newmtl a\nKd 1 1 1\nmap_Kd textures\\wood.ppm\nnewmtl b\nKe 0 0 0\nmap_Ke "
               "Textures/Wood.PPM\n");
  const std::string obj = "mtllib s.mtl\n" + kSquare + "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n";
  const Scene scene = load_scene(folder.write("s.obj", obj));
  CHECK(scene.textures.size() == 1);
  CHECK(material_called(scene, "a").reflectance_texture == 0);
  CHECK(material_called(scene, "b").emission == Rgb(1));
  folder.write("s.mtl", "newmtl a\nmap_Kd textures/stone.ppm\n");
  const Failure failure = load_failure(folder.write("s.obj", obj));
  CHECK(failure.code == ErrorCode::io);
  CHECK(failure.message == "s.mtl: material a: textures/stone.ppm: no such picture");
}

TEST_CASE("a missing material library is a warning and a grey material", "[load][obj]") {
  const TempFolder folder;
  const Scene scene =
      load_scene(folder.write("s.obj", "mtllib gone.mtl\n" + kSquare + "usemtl x\nf 1 2 3\n"));
  REQUIRE(!scene.warnings.empty());
  CHECK(contains(scene.warnings[0], "s.obj: the material library gone.mtl cannot be opened"));
  CHECK(scene.materials.at(0).reflectance == Rgb(0.5f));
}

TEST_CASE("numbers and indices that tinyobjloader would pass over are errors with their line",
          "[load][obj]") {
  CHECK(obj_failure("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n").message ==
        "s.obj:2: vertex 2 is not finite or too large: nan");
  CHECK(obj_failure("v 0 0 0\nv 1 0 -inf\nf 1 2 2\n").message ==
        "s.obj:2: vertex 2 is not finite or too large: -inf");
  CHECK(obj_failure("v 0 0 0\nv 1 1e999 0\n").message ==
        "s.obj:2: vertex 2 is not finite or too large: 1e999");
  CHECK(obj_failure("# a\nv 0 zero 0\n").message == "s.obj:2: vertex 1: \"zero\" is not a number");
  CHECK(obj_failure("v 0 0\n").message == "s.obj:1: vertex 1 has 2 numbers, it needs 3");
  CHECK(obj_failure("vt nan 0\n").message ==
        "s.obj:1: texture coordinate 1 is not finite or too large: nan");
  CHECK(obj_failure(kSquare + "f 1 2 5\n").message ==
        "s.obj:5: the face names vertex 5, there are 4");
  CHECK(obj_failure(kSquare + "f 1 2 3 4 99\n").message ==
        "s.obj:5: the face names vertex 99, there are 4");
  CHECK(obj_failure(kSquare + "f 1 2 -5\n").message ==
        "s.obj:5: the face names vertex -5, there are 4 before it");
  CHECK(obj_failure(kSquare + "f 1/1 2/1 3/1\n").message ==
        "s.obj:5: the face names texture coordinate 1, there are 0");
  CHECK(obj_failure(kSquare + "f 1//2 2//2 3//2\n").message ==
        "s.obj:5: the face names normal 2, there are 0");
  CHECK(obj_failure(kSquare + "f 0 1 2\n").message ==
        "s.obj:5: the face's corner \"0\" is no index, they start with 1");
  CHECK(obj_failure(kSquare + "f a b c\n").code == ErrorCode::bad_input);
  CHECK(obj_failure("v 1e-60 +1.5 -.5\nv 1. 0 0\nv 0 1 0 # corner\nf 1 2 3 # face\n")
            .message.empty());
}

TEST_CASE("what has no area or no normal is mended with one warning each", "[load][validate]") {
  const TempFolder folder;
  const Scene scene = load_scene(
      folder.write("s.obj", kSquare + "v 0.5 0 0\nvn 0 0 0\nf 1//1 2//1 3//1\nf 1//1 1//1 2//1\nf "
                                      "1//1 5//1 2//1\nf 1//1 3//1 4//1\n"));
  REQUIRE(scene.warnings.size() == 3);
  CHECK(contains(
      scene.warnings[0],
      "2 of 4 triangles have no area and are left out (the first is triangle 1 of mesh /default)"));
  CHECK(contains(scene.warnings[1],
                 "normals of length 0 are replaced by those of the triangles around"));
  CHECK(contains(scene.warnings[2], "nothing in the scene gives light"));
  CHECK(scene.meshes[0].triangles.size() == 2);
  for (const auto& triangle : scene.meshes[0].triangles) {
    for (const std::uint32_t i : triangle) CHECK(scene.meshes[0].normals[i] == Vec3(0, 0, 1));
  }
  CHECK(contains(obj_failure("v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n").message,
                 "no triangle of the scene has an area"));
  CHECK(obj_failure("").message == "s.obj: the scene has no shapes, there is nothing to render");
  CHECK(contains(obj_failure("v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n").message,
                 "mesh /default: vertex 1 is farther away than 1e+18"));
}

TEST_CASE("small and large triangles with an area are kept", "[load][validate]") {
  const TempFolder folder;
  const Scene scene =
      load_scene(folder.write("s.obj",
                              "v 0 0 0\nv 1e-15 0 0\nv 0 1e-15 0\nv 1e9 0 0\nv 0 1e9 0\nv 1 0.001 "
                              "0\nv 1 0 0\nf 1 2 3\nf 1 4 5\nf 1 7 6\n"));
  CHECK(scene.meshes[0].triangles.size() == 3);
}

}  // namespace
}  // namespace psf::render
