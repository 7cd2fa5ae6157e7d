// OBJ and MTL: what becomes of faces and materials, and what is refused.
#include <algorithm>

#include "catch.h"
#include "load_support.h"

namespace psf::render {
namespace {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Failure obj_failure(const std::string& text) {
  const TempFolder folder;
  return load_failure(folder.write("s.obj", text));
}

// The scene of an OBJ file and, where given, its library s.mtl.
Scene obj_scene(const std::string& text, const std::string& mtl = {}) {
  const TempFolder folder;
  if (!mtl.empty()) folder.write("s.mtl", mtl);
  return load_scene(folder.write("s.obj", text));
}

bool warns(const Scene& scene, const std::string& what) {
  return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                     [&](const std::string& warning) { return contains(warning, what); });
}

double area(const Scene& scene) {
  double sum = 0;
  for (const Mesh& mesh : scene.meshes) {
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 n =
          cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
      sum += double{n.length()} / 2;
    }
  }
  return sum;
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

TEST_CASE("a missing material library is a warning and a grey material", "[load][obj]") {
  const TempFolder folder;
  const Scene scene =
      load_scene(folder.write("s.obj", "mtllib gone.mtl\n" + kSquare + "usemtl x\nf 1 2 3\n"));
  REQUIRE(scene.warnings.size() == 3);
  CHECK(contains(scene.warnings[0], "s.obj:1: the material library gone.mtl cannot be opened"));
  CHECK(contains(scene.warnings[1], "s.obj:7: no material library has \"x\": grey instead"));
  CHECK(scene.materials.at(0).reflectance == Rgb(0.5f));
}

TEST_CASE("numbers and indices that are none are errors with their line", "[load][obj]") {
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
  CHECK(obj_failure("v 0,5 0 0\n").message ==
        "s.obj:1: vertex 1: \"0,5\" is not a number (decimals take a point, numbers a space "
        "between)");
  CHECK(obj_failure("v 0 0 0 1 1\n").message == "s.obj:1: vertex 1 has 5 numbers, it needs 6");
  CHECK(obj_failure("v 0 0 0\nvn 0 1\n").message == "s.obj:2: normal 1 has 2 numbers, it needs 3");
  CHECK(obj_failure("vt\n").message == "s.obj:1: texture coordinate 1 lacks a number");
  CHECK(obj_failure(kSquare + "f 1/1/1/1 2 3\n").message ==
        "s.obj:5: the face's corner \"1/1/1/1\" is no index, they start with 1");
  CHECK(obj_failure(kSquare + "f 1 2 99999999999999999999\n").code == ErrorCode::bad_input);
  CHECK(obj_failure("v 0 0 \\\n0\nv 1 x 0\n").message ==
        "s.obj:3: vertex 2: \"x\" is not a number");
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
  const Failure far = obj_failure("v 0 0 0\nv 1e37 0 0\nv 0 1e37 0\nf 1 2 3\n");
  CHECK(far.code == ErrorCode::limit);
  CHECK(contains(far.message, "the scene reaches 1e+37 units from the origin, 1e+36 are the most"));
}

TEST_CASE("small and large triangles with an area are kept", "[load][validate]") {
  const TempFolder folder;
  const Scene scene =
      load_scene(folder.write("s.obj",
                              "v 0 0 0\nv 1e-15 0 0\nv 0 1e-15 0\nv 1e9 0 0\nv 0 1e9 0\nv 1 0.001 "
                              "0\nv 1 0 0\nf 1 2 3\nf 1 4 5\nf 1 7 6\n"));
  CHECK(scene.meshes[0].triangles.size() == 3);
}

TEST_CASE("names of materials are the rest of the line, in OBJ as in MTL", "[load][obj]") {
  const std::string names[] = {"wall paint",   "a\tb",        "#1",   "x #2",
                               "Material #25", "f\xC3\xA4rg", "\"q\""};
  for (const std::string& name : names) {
    CAPTURE(name);
    const Scene scene =
        obj_scene("mtllib s.mtl\n" + kSquare + "usemtl " + name + " \t\r\nf 1 2 3\n",
                  "newmtl   " + name + "\r\nKd 0.25 0.5 0.75\n");
    REQUIRE(scene.materials.size() == 1);
    CHECK(scene.materials[0].name == name);
    CHECK(scene.meshes.at(0).name == "/" + name);
    CHECK(scene.materials[0].reflectance == Rgb(0.25f, 0.5f, 0.75f));
  }
  // Latin-1 in one file and UTF-8 in the other are the same name, and what we say is UTF-8.
  const Scene scene = obj_scene("mtllib s.mtl\n" + kSquare + "usemtl f\xE4rg\nf 1 2 3\n",
                                "newmtl f\xC3\xA4rg\nKd 1 0 0\n");
  REQUIRE(scene.materials.size() == 1);
  CHECK(scene.materials[0].name == "f\xC3\xA4rg");
  // A comment behind the name is none of it, where the name with it is not there.
  CHECK(obj_scene("mtllib s.mtl\n" + kSquare + "usemtl red # paint\nf 1 2 3\n", "newmtl red\n")
            .materials.size() == 1);
}

TEST_CASE("faces whose material no library has are grey, and their materials are named once",
          "[load][obj]") {
  std::string text = kSquare;
  for (int i = 0; i < 20; ++i) text += "usemtl m" + std::to_string(i % 10) + "\nf 1 2 3\n";
  const Scene scene = obj_scene(text);
  CHECK(scene.materials.size() == 1);
  CHECK(warns(scene,
              "s.obj:6: no material library has \"m0\", \"m1\", \"m2\", \"m3\", \"m4\", "
              "\"m5\", \"m6\", \"m7\" and 2 more: grey instead"));
}

TEST_CASE("material libraries are found whatever their names, several on a line", "[load][obj]") {
  const TempFolder folder;
  folder.write("a.mtl", "newmtl a\nKd 1 0 0\nnewmtl twice\nKd 0 1 0\n");
  folder.write("my own b.mtl", "newmtl b\nnewmtl twice\nKd 0 0 1\n");
  folder.write("lib/C.mtl", "newmtl c\n");
  folder.write("f\xE4rg.mtl", "newmtl d\n");
  const auto load = [&](const std::string& libraries) {
    return load_scene(folder.write("s.obj", "mtllib " + libraries + "\n" + kSquare + "f 1 2 3\n"));
  };
  const auto names = [](const Scene& scene) {
    std::string all;
    for (const Material& material : scene.materials) all += material.name + " ";
    return all;
  };
  CHECK(names(load("a.mtl")) == "a twice default ");
  CHECK(names(load("my own b.mtl")) == "b twice default ");
  CHECK(names(load("\"my own b.mtl\"")) == "b twice default ");
  CHECK(names(load("my\\ own\\ b.mtl")) == "b twice default ");
  CHECK(names(load("lib\\c.mtl")) == "c default ");
  CHECK(names(load("./lib/C.mtl\r")) == "c default ");
  CHECK(names(load("f\xE4rg.mtl")) == "d default ");
  CHECK(names(load("a.mtl my own b.mtl\tlib\\C.mtl")) == "a twice b c default ");
  CHECK(names(load("a.mtl\nmtllib lib/C.mtl\nmtllib a.mtl")) == "a twice c default ");
  const Scene both = load("a.mtl my own b.mtl");
  CHECK(both.materials[1].reflectance == Rgb(0, 1, 0));
  CHECK(warns(both, "my own b.mtl:2: another material is called \"twice\", the first counts"));
  const Scene missing = load("not there.mtl a.mtl nor this.mtl");
  CHECK(names(missing) == "a twice default ");
  CHECK(warns(missing, "s.obj:1: the material library not there.mtl cannot be opened"));
  CHECK(warns(missing, "s.obj:1: the material library nor this.mtl cannot be opened"));
  std::string words;
  for (int i = 0; i < 3000; ++i) words += "w" + std::to_string(i % 10) + " ";
  CHECK(names(load(words + "a.mtl my own b.mtl")) == "a twice b default ");
  CHECK(warns(load("lib"), "s.obj:1: the material library lib cannot be opened"));
}

TEST_CASE("a byte order mark, any line end and continued lines hide nothing", "[load][obj]") {
  const std::string mark = "\xEF\xBB\xBF";
  const Scene scene = obj_scene(mark + "mtllib s.mtl\n" + kSquare + "usemtl red\nf 1 2 3 4\n",
                                mark + "newmtl red\nKd 1 0 0\n");
  CHECK(scene.materials.at(0).name == "red");
  CHECK(scene.warnings.size() == 1);  // no light
  CHECK(area(obj_scene(mark + kSquare + "f 1 2 3 4\n")) == Approx(1));
  std::string returns = kSquare + "f 1 2 3 4";
  std::replace(returns.begin(), returns.end(), '\n', '\r');
  CHECK(area(obj_scene(returns)) == Approx(1));
  CHECK(area(obj_scene(kSquare + "f 1 2 \\\r\n3 \\\r\n4\r\n")) == Approx(1));
  CHECK(area(obj_scene("# in C:\\\n" + kSquare + "\tf\t1 2\t3 4 # all\n")) == Approx(1));
  CHECK(obj_failure("\xFF\xFEv").message ==
        "s.obj: the text is UTF-16, save it as UTF-8 or plain ASCII");
}

TEST_CASE("a backslash at the end of a comment continues nothing", "[load][obj]") {
  const TempFolder folder;
  const Scene scene =
      load_scene(folder.write("s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0 # the corner \\\nf 1 2 3\n"));
  CHECK(scene.meshes.at(0).triangles.size() == 1);
}

TEST_CASE("what an OBJ file says and the picture does not show is named once", "[load][obj]") {
  const Scene scene = obj_scene(
      "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 0 0 1 0.5\nvp 0.5 0.5\nvp 1 1\ns 1\n"
      "f 1 2 3\nf 1 2\nl 1 2\np 1\ncurv 0 1 1 2 3\nend\nlod 3\nusemap wood\nmg off\n");
  CHECK(warns(scene,
              "s.obj: left out: vertex colours, weights of vertices, vp, smoothing groups of "
              "faces without normals, faces of one or two corners, l, p, curv, end, lod, "
              "usemap, mg"));
  CHECK(scene.warnings.size() == 2);
  CHECK(warns(obj_scene("v 0 0 0\nv 1 0 0\nv 0 1 0 0.5 1 0 0\nvn 0 0 1 2\nf 1 2 3\n"),
              "left out: weights of vertices, vertex colours, a fourth number of normals"));
  // What changes nothing is not told of.
  const Scene quiet = obj_scene(
      "v 0 0 0 1.0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0 0\no a\ng b c\n"
      "s off\nf 1 2 3\ns 1\nf 1/1/1 2/1/1 3/1/1\n");
  CHECK(quiet.warnings.size() == 1);  // no light
  std::string noise = kSquare + "f 1 2 3\n";
  for (int i = 0; i < 100; ++i) noise += "word-" + std::to_string(i) + "\n";
  CHECK_FALSE(warns(obj_scene(noise), "word"));
  CHECK(warns(obj_scene(noise), "s.obj: left out: lines that are no statement"));
  const std::string letters = "abcdefghijklmnopqrstuvwxyz";
  for (const char a : letters) noise += std::string("x") + a + "\n";
  CHECK(warns(obj_scene(noise), "xo and 11 more"));
  CHECK(warns(obj_scene(kSquare + "f 1 2 3\n\x1b[31m\n"), "left out: lines that are no statement"));
}

TEST_CASE("concave faces keep their area and front, whatever corner they start with",
          "[load][obj]") {
  const std::string corners = "v 0 0 3\nv 4 0 3\nv 4 4 3\nv 2 1 3\nv 0 4 3\nvt 0 0\nvn 0 0 1\n";
  for (int start = 0; start < 5; ++start) {
    for (const int step : {1, 4}) {
      std::string face = "f";
      for (int i = 0; i < 5; ++i) face += " " + std::to_string((start + i * step) % 5 + 1) + "/1/1";
      CAPTURE(face);
      const Scene scene = obj_scene(corners + face + "\n");
      CHECK(area(scene) == Approx(10));
      CHECK(scene.meshes.at(0).triangles.size() == 3);
      CHECK(scene.meshes[0].positions.size() == 5);
      for (const auto& [a, b, c] : scene.meshes[0].triangles) {
        const auto& p = scene.meshes[0].positions;
        CHECK((cross(p[b] - p[a], p[c] - p[a]).z > 0) == (step == 1));
      }
    }
  }
}

TEST_CASE("faces that repeat a corner or cross themselves are named with their first line",
          "[load][obj]") {
  const Scene scene = obj_scene(
      "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nvt 0 0\nvt 1 1\nvt 1 0\nvt 0 1\n"
      "f 1/1 3/3 2/2 4/4\nf 1 1 3 2 4\nf 1/1 2/2 3/3 4/4\nf 1 2 3 4\nf 1 3 2 2\n");
  CHECK(warns(scene, "s.obj:10: 2 faces with a corner twice in a row, which counts once"));
  CHECK(warns(scene, "s.obj:11: 2 faces crossing over, drawn wherever its outline goes around"));
  CHECK(area(scene) == Approx(4 + 4 + 2 + 2 + 2));
  // Where the edges cross there is a vertex, with the mean of the texture coordinates.
  const Mesh& mesh = scene.meshes.at(0);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.positions[i] == Vec3(1, 1, 0) && mesh.uvs[i] != Vec2(0, 0)) {
      CHECK(mesh.uvs[i].x == Approx(0.5));
      CHECK(mesh.uvs[i].y == Approx(0.5));
    }
  }
}

}  // namespace
}  // namespace psf::render
