// Material libraries: what becomes of each statement, and what is refused.
#include <algorithm>

#include "analytic_support.h"
#include "load_support.h"

namespace psf::render {
namespace {

const std::string kObj =
    "mtllib s.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";

Scene mtl_scene(const std::string& mtl) {
  const TempFolder folder;
  folder.write("s.mtl", mtl);
  folder.write("w.ppm", ppm(1, "255 255 255"));
  folder.write("two words.ppm", ppm(1, "255 255 255"));
  folder.write("7", ppm(1, "255 255 255"));
  folder.write("-s.ppm", ppm(1, "255 255 255"));
  return load_scene(folder.write("s.obj", kObj));
}
// The material that these statements define.
Material mtl_material(const std::string& statements) {
  return mtl_scene("newmtl m\n" + statements).materials.at(0);
}
std::string failure_of(const std::string& statements) {
  const TempFolder folder;
  folder.write("s.mtl", "newmtl m\n" + statements);
  const Failure failure = load_failure(folder.write("s.obj", kObj));
  if (!failure.message.empty()) CHECK(failure.code == ErrorCode::bad_input);
  return failure.message;
}
// What is said to be left out, empty for nothing.
std::string left_out_of(const std::string& statements) {
  const Scene scene = mtl_scene("newmtl m\n" + statements);
  const std::string mark = "s.mtl: left out: ";
  std::string all;
  for (const std::string& warning : scene.warnings) {
    const std::size_t at = warning.find(mark);
    if (at != std::string::npos) all += warning.substr(at + mark.size());
  }
  return all;
}

// Mean radiance from above of a square of 2 x 2 at z = 0 under a white sky, or of a box of 2 x 2 x
// 1 whose top that is.
Rgb under_white_sky(const std::string& statements, bool box = false) {
  const TempFolder folder;
  folder.write("s.mtl", "newmtl m\n" + statements);
  std::string obj = "mtllib s.mtl\nusemtl m\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
  if (box) {
    obj +=
        "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nf 8 7 6 5\n"
        "f 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";
  }
  SceneOverrides overrides;
  overrides.sky = Rgb(1);
  const Scene scene = load_scene(folder.write("s.obj", obj), overrides);
  const auto integrator = test::make(scene, "path", 64);
  constexpr std::uint64_t kPaths = 16384;
  Imath::V3d sum(0);
  for (std::uint64_t i = 0; i < kPaths; ++i) {
    const Rgb c = test::pixel(test::trace(*integrator, test::ray({0.3f, 0.2f, 5}, {0.3f, 0.2f, 0}),
                                          SamplerKind::sobol, 0, i));
    sum += Imath::V3d(double{c.x}, double{c.y}, double{c.z});
  }
  return Rgb(Vec3(sum / double{kPaths}));
}

void check_close(const Rgb& found, const Rgb& expected, double relative) {
  CAPTURE(found, expected);
  for (int c = 0; c < 3; ++c) CHECK(found[c] == Approx(double{expected[c]}).epsilon(relative));
}

TEST_CASE("what MTL leaves out has the format's value, whatever stands before", "[load][mtl]") {
  const Scene scene = mtl_scene(
      "newmtl first\nKd 0.2 0.2 0.2\nKs 0.3 0.3 0.3\nKe 1 2 3\nNs 9\nd 0.1\nTf 0 0 0\nNi 2\nPr "
      "0.3\n"
      "illum 7\nnewmtl m\nmap_Kd w.ppm\n");
  const Material& m = scene.materials.at(1);
  CHECK(m.kind == MaterialKind::diffuse);
  CHECK(m.reflectance == Rgb(1));
  CHECK(m.reflectance_texture == 0);
  CHECK(m.emission == Rgb(0));
  CHECK(m.ior == 1.5f);
  CHECK(mtl_material("").reflectance == Rgb(0.5f));  // as without a material
  CHECK(mtl_material("Ke 1 1 1").reflectance == Rgb(0));
  CHECK(mtl_material("Kd 0.25 0.5 0.75\nmap_Kd w.ppm").reflectance == Rgb(0.25f, 0.5f, 0.75f));
  CHECK(mtl_material("map_Ke w.ppm").emission == Rgb(1));
  CHECK(mtl_material("Ke 0 0 0\nmap_Ke w.ppm").emission == Rgb(1));
  CHECK(mtl_material("Ke 2 3 4\nmap_Ke w.ppm").emission == Rgb(2, 3, 4));
}

TEST_CASE("a colour is three numbers, or one for grey, or CIE XYZ", "[load][mtl]") {
  CHECK(mtl_material("Kd 0.4").reflectance == Rgb(0.4f));
  CHECK(mtl_material("Kd 0.4 # grey").reflectance == Rgb(0.4f));
  CHECK(mtl_material("\tKd\t+.1 1e-1  0.1\t\r").reflectance == Rgb(0.1f));
  CHECK(mtl_material("kd 0.4 0.5 0.6").reflectance == Rgb(0.4f, 0.5f, 0.6f));
  CHECK(mtl_material("Kd 1.00001 0 0").reflectance == Rgb(1, 0, 0));
  CHECK(left_out_of("Kd 1 1 1 1") == "a fourth number of Kd");
  // The standard's own primaries: half of white, and half of green.
  const Rgb white = mtl_material("Kd xyz 0.47525 0.5 0.54445").reflectance;
  const Rgb green = mtl_material("Kd xyz 0.1788 0.3576 0.0596").reflectance;
  for (int c = 0; c < 3; ++c) {
    CHECK(white[c] == Approx(0.5).margin(1e-3));
    CHECK(green[c] == Approx(c == 1 ? 0.5 : 0).margin(1e-3));
  }
}

TEST_CASE("every number of a library is checked where it stands", "[load][mtl]") {
  CHECK(failure_of("Kd nan nan nan") == "s.mtl:2: Kd is not finite or too large: nan");
  CHECK(failure_of("\nKd 0,4 0,4 0,4") ==
        "s.mtl:3: Kd: \"0,4\" is not a number (decimals take a point, numbers a space between)");
  CHECK(failure_of("Kd 0.1 0.2") == "s.mtl:2: Kd lacks a number");
  CHECK(failure_of("Kd") == "s.mtl:2: Kd lacks a number");
  CHECK(failure_of("Kd 1.5 0 0") == "s.mtl:2: Kd is 1.5, expected a number in [0, 1]");
  CHECK(failure_of("Kd xyz 1 0 0") == "s.mtl:2: Kd is 3.2406, expected a number in [0, 1]");
  CHECK(failure_of("Kd spectral file.rfl 1") ==
        "s.mtl:2: Kd spectral: spectral curves are not read, give r g b");
  CHECK(failure_of("Ke -1 0 0") == "s.mtl:2: Ke is -1, expected a number >= 0");
  CHECK(failure_of("Ke 1e39") == "s.mtl:2: Ke is not finite or too large: 1e39");
  for (const std::string name : {"Ka", "Kd", "Ks", "Tf", "Ke", "d", "Tr", "Ns", "Ni", "Pr", "Pm",
                                 "Ps", "Pc", "Pcr", "aniso", "anisor", "sharpness", "illum"}) {
    CHECK(failure_of(name + " 1.#QNAN") == "s.mtl:2: " + name + ": \"1.#QNAN\" is not a number");
    CHECK(failure_of(name + " inf") == "s.mtl:2: " + name + " is not finite or too large: inf");
    CHECK(failure_of(name) == "s.mtl:2: " + name + " lacks a number");
  }
  for (const std::string name : {"Ks", "Tf", "d", "Tr", "Pr", "Pm"}) {
    CHECK(failure_of(name + " -0.5") ==
          "s.mtl:2: " + name + " is -0.5, expected a number in [0, 1]");
    CHECK(failure_of(name + " 7") == "s.mtl:2: " + name + " is 7, expected a number in [0, 1]");
  }
  for (const std::string name : {"d", "Tr", "Pr", "Pm"}) {  // what a converter rounded
    CHECK(failure_of(name + " 1.000001").empty());
    CHECK(failure_of(name + " -0.00001").empty());
  }
  CHECK(failure_of("Ni 0.5") == "s.mtl:2: Ni is 0.5, expected a number in [1, 10]");
  CHECK(failure_of("illum 1.5") == "s.mtl:2: illum is no whole number");
  CHECK(failure_of("illum 11") == "s.mtl:2: illum is 11, expected a number in [0, 10]");
  CHECK(failure_of("map_Kd -s x y w.ppm") == "s.mtl:2: -s: \"x\" is not a number");
  CHECK(failure_of("map_Kd") == "s.mtl:2: map_Kd lacks the name of a picture");
  CHECK(failure_of("newmtl") == "s.mtl:2: newmtl lacks a name");
  const TempFolder folder;
  folder.write("s.mtl", "# head\nKd 1 1 1\nnewmtl m\n");
  CHECK(load_failure(folder.write("s.obj", kObj)).message ==
        "s.mtl:2: Kd stands before the first newmtl");
}

TEST_CASE("maps are found by the rest of the line behind their options", "[load][mtl]") {
  for (const std::string name :
       {"w.ppm", "two words.ppm", "\"two words.ppm\"", "two\\ words.ppm", ".\\w.ppm", "W.PPM",
        "-s 2 2 7", "-s 1 7", "-o 0.5 w.ppm", "-bm 1 -clamp on two words.ppm", "-s.ppm"}) {
    CAPTURE(name);
    CHECK(mtl_material("map_Kd " + name).reflectance_texture == 0);
    CHECK(mtl_material("map_Ke " + name).emission_texture == 0);
  }
  const TempFolder folder;
  folder.write("s.mtl", "newmtl m\nmap_Kd no such.ppm\n");
  const Failure failure = load_failure(folder.write("s.obj", kObj));
  CHECK(failure.code == ErrorCode::io);
  CHECK(failure.message == "s.mtl:2: material m: no such.ppm: no such picture");
}

TEST_CASE("what a library says and the picture does not show is named once", "[load][mtl]") {
  CHECK(left_out_of("disp h.png\n"
                    "decal d.png\nrefl -type sphere r.png\nmap_Ns s.png\nmap_Ks s.png\n"
                    "map_aat on\nmap_Pr p.png") ==
        "disp, decal, refl, map_Ns, map_Ks, map_aat, map_Pr");
  CHECK(left_out_of("Ni 1.45 1.45\nillum 2 3\nd 1 x\nKd 1 1 1 # white") ==
        "what follows the number of Ni, what follows the number of illum, what follows the number "
        "of d");
  CHECK(left_out_of("Ps 0.5\nPc 0\nPcr 0.1\naniso 0.2\nanisor 0\nunheard of") ==
        "Ps, Pcr, aniso, unheard");
  CHECK(left_out_of("map_Kd -s 2 2 2 -o 0 1 -t 1 -mm 0.1 1 -clamp on -blendu off -blendv off "
                    "-cc on -texres 512 -imfchan r -bm 2 -boost 3 -type sphere w.ppm") ==
        "option -s of map_Kd, option -o of map_Kd, option -t of map_Kd, option -mm of map_Kd, "
        "option -clamp of map_Kd, option -blendu of map_Kd, option -blendv of map_Kd, option -cc "
        "of map_Kd, option -texres of map_Kd, option -imfchan of map_Kd, option -bm of map_Kd, "
        "option -boost of map_Kd, option -type of map_Kd");
  CHECK(left_out_of("map_Ke -s 3 w.ppm") == "option -s of map_Ke");
  CHECK(left_out_of("d 0.75").empty());
  CHECK(left_out_of("d -halo 1") == "d -halo");
  CHECK(left_out_of("d 1\nTr 1") == "Tr that contradicts d");
  CHECK(left_out_of("illum 10") == "illum 10 (shadows on what is not seen)");
  CHECK(left_out_of("illum 4\nmap_Kd w.ppm") == "map_Kd of glass");
  // What changes nothing is not told of.
  CHECK(left_out_of(
            "Ka 1 1 1\nmap_Ka w.ppm\nsharpness 60\nd 1\nTr 0\nTf 1 1 1\nNs 10\nNi 1\nillum 2\n"
            "Ps 0\nPc 0\nmap_Kd -s 1 1 1 -o 0 0 0 -t 0 0 0 -mm 0 1 -clamp off -blendu on "
            "-blendv on -cc off -bm 1 -boost 0 -colorspace sRGB w.ppm") == "");
}

TEST_CASE("MTL maps to our materials as documented", "[load][mtl]") {
  CHECK(mtl_material("illum 1\nKd 0.1 0.2 0.3\nKs 1 1 1").kind == MaterialKind::diffuse);
  CHECK(mtl_material("Kd 0 0 0\nKe 5 6 7").emission == Rgb(5, 6, 7));
  CHECK(mtl_material("Kd 1").two_sided);
  const Material shiny = mtl_material("illum 2\nKd 0.5 0.4 0.3\nKs 0.2 0.1 0\nNs 30\nNi 1.4");
  CHECK(shiny.kind == MaterialKind::gloss);
  CHECK(shiny.reflectance == Rgb(0.5f, 0.4f, 0.3f));
  CHECK(shiny.specular == Rgb(0.2f, 0.1f, 0));
  // Ns 30: alpha^2 = 2 / 32, so alpha = 1/4 and the perceptual roughness 1/2.
  CHECK(shiny.roughness == Approx(0.5));
  CHECK(mtl_material("Kd 0.5\nKs 0.2\nNs -2").roughness == 1);  // without illum Ks counts
  CHECK(mtl_material("Kd 0.5\nKs 0\nillum 2").kind == MaterialKind::diffuse);
  for (const std::string model : {"3", "5", "8"}) {
    const Material m = mtl_material("Kd 0.5\nKs 0.2\nNs 30\nillum " + model);
    CHECK(m.kind == MaterialKind::gloss);
    CHECK(m.roughness == 0);
  }
  CHECK(mtl_material("map_Kd w.ppm\nKs 0.2").reflectance_texture == 0);
  const Material metal = mtl_material("illum 2\nKd 0 0 0\nKs 0.9 0.7 0.5\nNs 126");
  CHECK(metal.kind == MaterialKind::conductor);
  CHECK(metal.reflectance == Rgb(0.9f, 0.7f, 0.5f));
  CHECK(metal.roughness == Approx(0.35355).epsilon(1e-4));
  const Material mirror = mtl_material("illum 3\nKd 0 0 0\nKs 0.8 0.8 0.8");
  CHECK(mirror.kind == MaterialKind::mirror);
  CHECK(mirror.reflectance == Rgb(0.8f));
  const Material pbr = mtl_material("Kd 0.4 0.4 0.4\nPr 0.25\nPm 0.75\nKs 1\nillum 2");
  CHECK(pbr.kind == MaterialKind::coat);
  CHECK(pbr.roughness == 0.25f);
  CHECK(pbr.metalness == 0.75f);
  CHECK(mtl_material("Kd 0.4\nPm 1\nNs 30").roughness == Approx(0.5));
  const Material glass = mtl_material("illum 7\nKd 1 1 1\nNi 1.33\nTf 0.25 0.49 1");
  CHECK(glass.kind == MaterialKind::glass);
  CHECK(glass.ior == Approx(1.33));
  CHECK(glass.reflectance.x == Approx(0.5));
  CHECK(glass.reflectance.y == Approx(0.7));
  CHECK(glass.reflectance.z == Approx(1));
  CHECK(mtl_material("illum 4\nNi 1").ior == 1);
  for (const std::string clear : {"d 0.1", "Tr 0.9", "illum 4", "illum 6", "illum 9"}) {
    CAPTURE(clear);
    CHECK(mtl_material(clear).kind == MaterialKind::glass);
    CHECK(mtl_material(clear).reflectance == Rgb(1));
  }
  for (const std::string solid : {"d 1\nTr 1", "Tr 1\nd 1", "Tr 0", "d 0.5"}) {
    CAPTURE(solid);
    CHECK(mtl_material(solid).kind == MaterialKind::diffuse);
  }
}

TEST_CASE("under a white sky a glossy surface shows Ks and what Kd makes of the rest",
          "[load][mtl]") {
  for (const std::string model : {"3", "5", "8"}) {
    CAPTURE(model);
    // A mirror in all but its name, whose Kd is small beside its Ks.
    check_close(under_white_sky("illum " + model + "\nKd 0.05\nKs 0.95\nNs 1000"),
                Rgb(0.95f + 0.05f * 0.05f), 2e-3);
    check_close(under_white_sky("illum " + model + "\nKd 0.6 0.4 0.2\nKs 0.2 0.3 0.9"),
                Rgb(0.2f + 0.8f * 0.6f, 0.3f + 0.7f * 0.4f, 0.9f + 0.1f * 0.2f), 5e-3);
    check_close(under_white_sky("illum " + model + "\nKs 0.8 0.7 0.6"), Rgb(0.8f, 0.7f, 0.6f),
                1e-4);
  }
  check_close(under_white_sky("illum 2\nKd 0.6 0.4 0.2\nKs 0.2 0.3 0.9\nNs 5000"),
              Rgb(0.2f + 0.8f * 0.6f, 0.3f + 0.7f * 0.4f, 0.9f + 0.1f * 0.2f), 1e-2);
  // Nothing is lost or made where the base is white, however rough.
  for (const std::string exponent : {"0", "3", "30"})
    check_close(under_white_sky("Kd 1\nKs 0.2 0.3 0.9\nNs " + exponent), Rgb(1), 1e-2);
  check_close(under_white_sky("illum 1\nKd 0.6 0.4 0.2\nKs 0.2 0.3 0.9"), Rgb(0.6f, 0.4f, 0.2f),
              1e-4);
}

TEST_CASE("light that crosses a closed body is multiplied by Tf once", "[load][mtl]") {
  const std::string glass = "illum 4\nTf 0.25 0.49 0.81\nNi ";
  check_close(under_white_sky(glass + "1", true), Rgb(0.25f, 0.49f, 0.81f), 1e-3);
  check_close(under_white_sky(glass + "1", false), Rgb(0.5f, 0.7f, 0.9f), 1e-3);
  // R = 0.04 at each surface: R + (1 - R)^2 Tf (1 + R + R^2 + ...), as the box has but two sides
  // for a ray straight down.
  check_close(under_white_sky(glass + "1.5", true),
              Rgb(0.04f + 0.96f * 0.25f, 0.04f + 0.96f * 0.49f, 0.04f + 0.96f * 0.81f), 1e-2);
  check_close(under_white_sky("d 0.1\nNi 1.5", true), Rgb(1), 1e-3);
}

}  // namespace
}  // namespace psf::render
