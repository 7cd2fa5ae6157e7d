// Names: outputs that are inputs or one another, names that are no UTF-8, long ones, places that
// may not be written.
#include <nlohmann/json.hpp>

#include "catch.h"
#include "confined.h"
#include "every_verb.h"

namespace fs = std::filesystem;
using namespace psf::tests;

namespace {

struct Clash {
  std::string command;
  std::string untouched;  // an input
};

// A file of each verb's that one of its outputs would overwrite.
const std::vector<Clash> kClashes = {
    {"psf-render OUT/room.json -o OUT/b.pvb --json OUT/room.json", "room.json"},
    {"psf-render OUT/room.json --image OUT/sky.exr --sky OUT/sky.exr", "sky.exr"},
    {"psf-render OUT/all.json --image OUT/sky.exr", "sky.exr"},
    {"psf-render OUT/all.json -o OUT/quad.bin", "quad.bin"},
    {"psf-render OUT/all.json --image OUT/b.exr --json OUT/quad.gltf", "quad.gltf"},
    {"psf-render OUT/all.json --image OUT/b.exr --json OUT/quad.obj", "quad.obj"},
    {"psf-render OUT/quad.obj --image OUT/b.exr --json OUT/quad.mtl", "quad.mtl"},
    {"psf-render OUT/quad.gltf -o OUT/b.pvb --json OUT/sky.exr", "sky.exr"},
    {"psf filter OUT/a.pvb -o OUT/f.exr --json OUT/a.pvb", "a.pvb"},
    {"psf filter OUT/a.pvb -o OUT/f.exr --json OUT/tuned.json --tuned OUT/tuned.json",
     "tuned.json"},
    {"psf info OUT/a.pvb --json OUT/a.pvb", "a.pvb"},
    {"psf verify OUT/a.pvb --json OUT/a.pvb", "a.pvb"},
    {"psf recover OUT/a.pvb OUT/a.pvb", "a.pvb"},
    {"psf recover OUT/a.pvb OUT/r.pvb --json OUT/a.pvb", "a.pvb"},
    {"psf cat OUT/a.pvb -o OUT/c.pvb --json OUT/a.pvb", "a.pvb"},
    {"psf export OUT/a.pvb -o OUT/a.pvb --format csv", "a.pvb"},
    {"psf export OUT/a.pvb -o OUT/a.pvb --format ply", "a.pvb"},
    {"psf export OUT/a.pvb -o OUT/e.csv --json OUT/a.pvb", "a.pvb"},
    {"psf export OUT/a.pvb -o OUT/a.pvb --for oidn", "a.pvb"},
    {"psf export OUT/a.pvb -o OUT/e --for oidn --json OUT/a.pvb", "a.pvb"},
    {"psf compare OUT/a.exr OUT/sky.exr --error OUT/a.exr", "a.exr"},
    {"psf compare OUT/sky.exr OUT/a.exr --error OUT/d.png --error OUT/a.exr", "a.exr"},
    {"psf compare OUT/a.exr OUT/sky.exr --json OUT/sky.exr", "sky.exr"},
    {"psf flicker OUT/s.####.exr --reference OUT/s.####.exr --json OUT/s.0001.exr", "s.0001.exr"},
    {"psf sweep OUT/a.pvb --reference OUT/a.exr --r0 4px -o OUT/s --json OUT/a.exr", "a.exr"},
    {"psf sweep OUT/study/sweep.csv --reference OUT/a.exr --r0 4px -o OUT/study", "a.exr"},
    {"psf sweep OUT/a.pvb --reference OUT/study/0001.exr --r0 4px --pictures -o OUT/study",
     "study/0001.exr"},
    {"psf converge OUT/a.pvb --reference OUT/a.exr --r0 4px -o OUT/g --json OUT/a.pvb", "a.pvb"},
    {"psf converge OUT/a.pvb --reference OUT/a.exr --r0 4px -o OUT/g --render-json OUT/a.json "
     "--json OUT/a.json",
     "a.json"},
    {"psf tune OUT/a.pvb --r0 4px,8px --json OUT/a.pvb", "a.pvb"},
    {"psf ablate OUT/a.pvb -o OUT/s.png --json OUT/a.pvb", "a.pvb"},
    {"psf ablate OUT/a.pvb --reference OUT/study/0001.exr -o OUT/study", "study/0001.exr"},
    {"psf explain OUT/a.pvb --pixel 8,6 --json OUT/a.pvb", "a.pvb"},
    {"psf explain OUT/a.pvb --pixel 8,6 --ply OUT/a.pvb", "a.pvb"},
    {"psf report OUT/sweep -o OUT/sweep/sweep.json", "sweep/sweep.json"},
    {"psf report OUT/sweep -o OUT/r.html --json OUT/sweep/0001.exr", "sweep/0001.exr"}};

// Outputs that are one file.
const std::vector<std::string> kTwice = {
    "psf-render OUT/room.json --image OUT/x.exr --image OUT/./x.exr",
    "psf filter OUT/a.pvb -o OUT/x.exr -o OUT/./x.exr",
    "psf filter OUT/a.pvb -o OUT/x.exr -o OUT/x.0001.exr --snapshots 1,2",
    "psf cat OUT/a.pvb -o OUT/x.pvb --json OUT/x.pvb",
    "psf recover OUT/a.pvb OUT/x.pvb --json OUT/x.pvb",
    "psf export OUT/a.pvb -o OUT/x.csv --json OUT/x.csv",
    "psf export OUT/a.pvb -o OUT/x --for nfor --json OUT/x",
    "psf compare OUT/a.exr OUT/sky.exr --error OUT/x.png --error OUT/study/../x.png",
    "psf flicker OUT/s.####.exr --reference OUT/s.####.exr --sheet OUT/x.png --sheet OUT/./x.png",
    "psf sweep OUT/a.pvb --reference OUT/a.exr --r0 4px -o OUT/x --json OUT/x/sweep.json",
    "psf converge OUT/a.pvb --reference OUT/a.exr --r0 4px -o OUT/x --json OUT/x/converge.csv",
    "psf ablate OUT/a.pvb -o OUT/x.png -o OUT/./x.png",
    "psf ablate OUT/a.pvb -o OUT/x --json OUT/x/ablate.csv",
    "psf explain OUT/a.pvb --pixel 8,6 --json OUT/x --ply OUT/x",
    "psf report OUT/sweep -o OUT/x.html --json OUT/x.html"};

// A scene of files: meshes, a library, a buffer and a picture.
void place_scene_of_files(const std::string& folder) {
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::ofstream(folder + "quad.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(corners), sizeof corners);
  std::ofstream(folder + "quad.gltf") << R"({"asset": {"version": "2.0"}, "scene": 0,
      "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "buffers": [{"uri": "quad.bin", "byteLength": 36}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                     "min": [0, 0, 0], "max": [1, 1, 0]}],
      "images": [{"uri": "sky.exr"}], "textures": [{"source": 0}],
      "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]})";
  std::ofstream(folder + "quad.mtl") << "newmtl grey\nKd 0.5 0.5 0.5\n";
  std::ofstream(folder + "quad.obj") << "mtllib quad.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                        "usemtl grey\nf 1 2 3\n";
  std::ofstream(folder + "all.json") << R"({
      "cameras": [{"eye": [0, 0, 4], "target": [0, 0, 0], "fov": 50, "size": [4, 4]}],
      "materials": [{"name": "map", "kind": "diffuse", "reflectance_map": "sky.exr"}],
      "shapes": [{"shape": "mesh", "file": "quad.gltf"}, {"shape": "mesh", "file": "quad.obj"},
                 {"shape": "sphere", "center": [0, 0, 0], "radius": 1, "material": "map"}]})";
}

// The inputs of the clashes, in the folder that is written to.
void place_inputs(const VerbInputs& inputs) {
  inputs.empty();
  for (const char* name : {"room.json", "a.pvb", "a.exr", "a.json", "tuned.json", "s.0000.exr",
                           "s.0001.exr", "s.0002.exr"}) {
    fs::copy(inputs.in() + name, inputs.out() + name);
  }
  fs::copy(inputs.in() + "a.exr", inputs.out() + "sky.exr");
  fs::copy(inputs.in() + "sweep", inputs.out() + "sweep");
  fs::create_directory(inputs.out() + "study");
  fs::copy(inputs.in() + "a.exr", inputs.out() + "study/0001.exr");
  fs::copy(inputs.in() + "a.pvb", inputs.out() + "study/sweep.csv");
  place_scene_of_files(inputs.out());
}

void check_refused(const VerbInputs& inputs, const std::string& command) {
  const std::vector<std::string> before = inputs.written();
  const Outcome outcome = inputs.try_out(command);
  INFO(command << "\n" << outcome.err);
  CHECK(outcome.code == 2);
  CHECK(is_one_line(outcome.err));
  CHECK(inputs.written() == before);
}

}  // namespace

TEST_CASE("an output that is an input is refused before anything is done") {
  const VerbInputs inputs;
  place_inputs(inputs);
  for (const Clash& clash : kClashes) {
    const std::string path = inputs.out() + clash.untouched;
    const std::string before = read_text(path);
    REQUIRE(before.size() > 10);
    check_refused(inputs, clash.command);
    CHECK(read_text(path) == before);
    // By any name.
    const std::size_t last = clash.command.rfind("OUT/" + clash.untouched);
    for (const bool hard : {false, true}) {
      const std::string link = inputs.out() + "link" + fs::path(path).extension().string();
      hard ? fs::create_hard_link(path, link) : fs::create_symlink(path, link);
      std::string command = clash.command;
      // Only what is named is an output: in a study's folder names are not chosen.
      if (command.find(" -o OUT/study") == std::string::npos) {
        command.replace(last, clash.untouched.size() + 4, link);
        check_refused(inputs, command);
        CHECK(read_text(path) == before);
      }
      fs::remove(link);
    }
  }
}

TEST_CASE("two outputs that are one file are refused before anything is done") {
  const VerbInputs inputs;
  place_inputs(inputs);
  for (const std::string& command : kTwice) check_refused(inputs, command);
}

TEST_CASE("standard output that is redirected to an input or an output is refused") {
  const VerbInputs inputs;
  place_inputs(inputs);
  const std::string dump = inputs.out() + "a.pvb", before = read_text(dump);
  const auto append_to = [](const std::string& path) {
    return [path] { dup2(open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT, 0600), STDOUT_FILENO); };
  };
  CHECK(run_confined(inputs.placed("psf info OUT/a.pvb"), append_to(dump)).code == 2);
  CHECK(read_text(dump) == before);
  const std::string text = inputs.out() + "text";
  for (const std::string& name : {text, std::string("/dev/stdout"), std::string("/dev/fd/1")}) {
    const Outcome outcome =
        run_confined(inputs.placed("psf info OUT/a.pvb --json ") + name, append_to(text));
    CHECK(outcome.code == 2);
    CHECK(fs::is_symlink("/dev/stdout"));
  }
  const Outcome piped = run_confined(inputs.placed("psf info OUT/a.pvb --json /dev/stdout"), [] {});
  CHECK(piped.code == 0);
  CHECK(piped.out.find("\"records\": ") != std::string::npos);
}

TEST_CASE("a dump may be joined under the name of an input, and a study may keep its reference") {
  const VerbInputs inputs;
  place_inputs(inputs);
  CHECK(inputs.try_out("psf cat OUT/a.pvb OUT/a.pvb -o OUT/a.pvb --quiet").code == 0);
  CHECK(inputs.try_out("psf verify OUT/a.pvb").out.find("in 8 passes") != std::string::npos);
  const std::string sweep =
      "psf sweep IN/a.pvb --reference OUT/sweep/reference.exr --pictures "
      "--resume -o OUT/sweep --r0 ";
  const std::string before = read_text(inputs.out() + "sweep/reference.exr");
  CHECK(inputs.try_out(sweep + "8px").code == 0);
  CHECK(read_text(inputs.out() + "sweep/reference.exr") == before);
}

TEST_CASE("names that are no UTF-8, have spaces, backslashes or newlines are names") {
  const VerbInputs inputs;
  const std::vector<std::string> names = {"caf\xe9", "two words\\", "new\nline'\"s"};
  for (const std::string& name : names) {
    inputs.empty();
    const auto quoted = [&](const std::string& end) {
      std::string text = "'";
      for (const char c : inputs.out() + name + end) {
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
      }
      return text + "'";
    };
    const std::string dump = quoted(".pvb"), picture = quoted(".exr"), json = quoted(".json");
    fs::copy(inputs.in() + "room.json", inputs.out() + name + ".room.json");
    const auto ok = [&](const std::string& command) {
      const Outcome outcome = inputs.try_out(command);
      INFO(command << "\n" << outcome.err);
      CHECK(outcome.code == 0);
    };
    const auto writes_json = [&](const std::string& command) {
      fs::remove(inputs.out() + name + ".json");
      ok(command + " --json " + json);
      CHECK(nlohmann::json::parse(read_text(inputs.out() + name + ".json")).is_object());
    };
    writes_json("psf-render " + quoted(".room.json") + " --passes 2 --quiet -o " + dump);
    writes_json("psf filter " + dump + " -o " + picture);
    writes_json("psf filter " + dump + " -o " + quoted(".png"));
    writes_json("psf info " + dump);
    writes_json("psf verify " + dump);
    writes_json("psf recover " + dump + " " + quoted(".r.pvb"));
    writes_json("psf cat " + dump + " -o " + quoted(".c.pvb"));
    writes_json("psf export " + dump + " -o " + quoted(".csv"));
    writes_json("psf export " + dump + " -o " + quoted(".ply"));
    writes_json("psf export " + dump + " -o " + quoted("") + " --format npy");
    writes_json("psf compare " + picture + " " + picture + " --error " + quoted(".e.exr"));
    writes_json("psf sweep " + dump + " --reference " + picture + " --r0 4px --pictures -o " +
                quoted(".sweep"));
    writes_json("psf converge " + dump + " --reference " + picture + " --r0 4px -o " +
                quoted(".converge"));
    writes_json("psf tune " + dump + " --r0 4px,8px --block 1pass");
    writes_json("psf ablate " + dump + " -o " + quoted(".sheet.png"));
    writes_json("psf explain " + dump + " --pixel 8,6 --ply " + quoted(".x.ply"));
    writes_json("psf report " + quoted(".sweep") + " " + quoted(".converge") + " -o " +
                quoted(".html"));
    ok("psf sweep " + dump + " --reference " + picture + " --r0 8px --resume -o " +
       quoted(".sweep"));
    const Outcome wrong = inputs.try_out("psf info " + quoted(".missing"));
    CHECK(wrong.code == 4);
    CHECK(is_one_line(wrong.err));
  }
}

TEST_CASE("names as long as the file system takes are written, longer ones are refused") {
  const VerbInputs inputs;
  for (const std::size_t size : {240u, 251u, 255u}) {
    inputs.empty();
    const auto named = [size](const std::string& end) {
      return "OUT/" + std::string(size - end.size(), 'n') + end;
    };
    for (const std::string& command :
         {"psf-render IN/room.json --passes 1 --quiet -o " + named(".pvb") + " --image " +
              named(".exr") + " --image " + named(".png") + " --json " + named(".json"),
          "psf cat IN/a.pvb -o " + named("c.pvb"), "psf recover IN/a.pvb " + named("r.pvb"),
          "psf export IN/a.pvb -o " + named(".ply"), "psf export IN/a.pvb -o " + named(".csv"),
          "psf export IN/a.pvb --format npy -o " + named("")}) {
      const Outcome outcome = inputs.try_out(command);
      INFO(command << "\n" << outcome.err);
      CHECK(outcome.code == 0);
    }
    CHECK(inputs.try_out("psf verify " + named(".pvb")).code == 0);
    for (const std::string& name : inputs.written()) {
      CHECK(name.find(".partial") == std::string::npos);
    }
  }
  inputs.empty();
  const std::string name = std::string(256 - 4, 'n');
  for (const std::string& command :
       {"psf-render IN/room.json -o OUT/" + name + ".pvb",
        "psf filter IN/a.pvb -o OUT/" + name + ".exr", "psf cat IN/a.pvb -o OUT/" + name + ".pvb",
        "psf info IN/a.pvb --json OUT/" + name + ".jso"}) {
    const Outcome outcome = inputs.try_out(command);
    INFO(command << "\n" << outcome.err);
    CHECK(outcome.code == 4);
    CHECK(is_one_line(outcome.err));
    CHECK(outcome.err.find("File name too long") != std::string::npos);
    CHECK(inputs.written().empty());
  }
}

TEST_CASE("a link to a file that is written stays a link") {
  const VerbInputs inputs;
  fs::create_directory(inputs.out() + "far");
  for (const std::string& name : {std::string("p.exr"), std::string("q.pvb")}) {
    fs::create_symlink("far/" + name, inputs.out() + name);
  }
  CHECK(inputs.try_out("psf filter IN/a.pvb -o OUT/p.exr").code == 0);
  CHECK(inputs.try_out("psf cat IN/a.pvb -o OUT/q.pvb").code == 0);
  for (const std::string& name : {std::string("p.exr"), std::string("q.pvb")}) {
    CHECK(fs::is_symlink(inputs.out() + name));
    CHECK(fs::is_regular_file(inputs.out() + "far/" + name));
  }
  CHECK(inputs.written().size() == 5);
}

TEST_CASE("what may not be read or written is an I/O error in one line, and all stays as it was") {
  const VerbInputs inputs;
  place_inputs(inputs);
  const auto mode = [&](const std::string& name, unsigned bits) {
    fs::permissions(inputs.out() + name, static_cast<fs::perms>(bits));
  };
  fs::create_directory(inputs.out() + "closed");
  fs::create_directory(inputs.out() + "locked");
  std::ofstream(inputs.out() + "secret.pvb") << read_text(inputs.out() + "a.pvb");
  std::ofstream(inputs.out() + "secret.exr") << read_text(inputs.out() + "a.exr");
  std::ofstream(inputs.out() + "secret.json") << read_text(inputs.out() + "room.json");
  std::ofstream(inputs.out() + "kept.exr") << "kept";
  std::ofstream(inputs.out() + "kept.json") << "kept";
  for (const char* name : {"secret.pvb", "secret.exr", "secret.json"}) mode(name, 0);
  for (const char* name : {"kept.exr", "kept.json"}) mode(name, 0444);
  mode("closed", 0);
  mode("locked", 0555);
  const std::vector<std::string> before = [&] {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(inputs.out())) names.push_back(entry.path());
    std::sort(names.begin(), names.end());
    return names;
  }();
  for (const std::string& command : {
           std::string("psf info OUT/secret.pvb"),
           std::string("psf verify OUT/secret.pvb"),
           std::string("psf filter OUT/secret.pvb -o OUT/x.exr"),
           std::string("psf recover OUT/secret.pvb OUT/x.pvb"),
           std::string("psf cat OUT/a.pvb OUT/secret.pvb -o OUT/x.pvb"),
           std::string("psf compare OUT/secret.exr OUT/a.exr"),
           std::string("psf compare OUT/a.exr OUT/secret.exr"),
           std::string("psf filter OUT/a.pvb --tuned OUT/secret.json -o OUT/x.exr"),
           std::string("psf-render OUT/secret.json -o OUT/x.pvb"),
           std::string("psf-render OUT/room.json -o OUT/locked/x.pvb"),
           std::string("psf-render OUT/room.json --image OUT/locked/x.exr"),
           std::string("psf filter OUT/a.pvb -o OUT/locked/x.exr"),
           std::string("psf filter OUT/a.pvb -o OUT/closed/x.exr"),
           std::string("psf filter OUT/a.pvb -o OUT/kept.exr"),
           std::string("psf filter OUT/closed/a.pvb -o OUT/x.exr"),
           std::string("psf info OUT/a.pvb --json OUT/kept.json"),
           std::string("psf info OUT/a.pvb --json OUT/closed"),
           std::string("psf info OUT/a.pvb --json OUT/"),
           std::string("psf info OUT"),
           std::string("psf compare OUT/sweep OUT/a.exr"),
           std::string("psf cat OUT/a.pvb -o OUT/locked/x.pvb"),
           std::string("psf export OUT/a.pvb -o OUT/locked/x.csv"),
           std::string("psf export OUT/a.pvb -o OUT/locked/arrays"),
           std::string("psf export OUT/a.pvb -o OUT/locked/nfor --for nfor"),
           std::string("psf sweep OUT/a.pvb --reference OUT/a.exr --r0 4px -o OUT/locked/sweep"),
           std::string("psf sweep OUT/a.pvb --reference OUT/a.exr --r0 4px -o OUT/locked"),
           std::string("psf report OUT/closed -o OUT/x.html"),
           std::string("psf report OUT/sweep -o OUT/locked/x.html"),
       }) {
    const Outcome outcome = run_confined(inputs.placed(command), become_somebody);
    INFO(command << "\n" << outcome.err);
    CHECK(outcome.code == 4);
    CHECK(is_one_line(outcome.err));
    CHECK(outcome.err.find("filesystem error") == std::string::npos);  // the library's own words
    CHECK(outcome.out.empty());
  }
  std::vector<std::string> after;
  for (const auto& entry : fs::directory_iterator(inputs.out())) after.push_back(entry.path());
  std::sort(after.begin(), after.end());
  CHECK(after == before);
  CHECK(read_text(inputs.out() + "kept.exr") == "kept");
  for (const char* name : {"closed", "locked"}) mode(name, 0777);
}
