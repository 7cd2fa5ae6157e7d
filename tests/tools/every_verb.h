// Every verb that reads and writes, on small files: for what holds for all of them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "catch.h"
#include "command.h"

namespace psf::tests {

// A folder with inputs for all verbs, "IN/", and one that takes what they write, "OUT/".
class VerbInputs {
 public:
  VerbInputs() {
    std::filesystem::create_directory(in());
    std::ofstream(in() + "room.json") << R"({
      "cameras": [{"name": "one", "eye": [0, 1, 4], "target": [0, 1, 0], "fov": 50,
                   "size": [16, 12]}],
      "materials": [{"name": "grey", "kind": "diffuse", "reflectance": 0.5}],
      "environment": {"radiance": 1},
      "shapes": [{"shape": "sphere", "center": [0, 1, 0], "radius": 1, "material": "grey"}]})";
    make("psf-render IN/room.json -o IN/a.pvb --passes 4 --layers lights --quiet --json IN/a.json");
    make("psf filter IN/a.pvb -o IN/a.exr");
    for (const char* frame : {"0000", "0001", "0002"}) {
      std::filesystem::copy_file(in() + "a.exr", in() + "s." + frame + ".exr");
    }
    make("psf tune IN/a.pvb --r0 4px,8px --block 1pass --json IN/tuned.json");
    make("psf sweep IN/a.pvb --reference IN/a.exr --r0 4px -o IN/sweep --pictures");
    empty();
  }

  [[nodiscard]] std::string in() const { return folder_ / "in/"; }
  [[nodiscard]] std::string out() const { return folder_ / "out/"; }
  // An empty folder for what is written, for any user.
  void empty() const {
    namespace fs = std::filesystem;
    fs::remove_all(out());
    fs::create_directory(out());
    fs::permissions(out(), fs::perms::all);
    fs::permissions(folder_.path(), fs::perms::all);
  }
  // What is in the folder that is written to, also in its folders, sorted.
  [[nodiscard]] std::vector<std::string> written() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(out())) {
      names.push_back(std::filesystem::relative(entry.path(), out()).string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  [[nodiscard]] std::string placed(std::string command) const {
    for (const auto& [name, folder] : {std::pair{"IN/", in()}, std::pair{"OUT/", out()}}) {
      for (std::size_t at = 0; (at = command.find(name, at)) != std::string::npos;) {
        command.replace(at, std::string(name).size(), folder);
        at += folder.size();
      }
    }
    return command;
  }
  [[nodiscard]] Outcome try_out(const std::string& command) const { return run(placed(command)); }

 private:
  void make(const std::string& command) const {
    const Outcome outcome = try_out(command);
    INFO(command << "\n" << outcome.err);
    REQUIRE(outcome.code == 0);
  }

  TempFolder folder_;
};

// Each writes all that it can.
inline const std::vector<std::string>& every_verb() {
  static const std::vector<std::string> verbs = {
      "psf-render IN/room.json -o OUT/b.pvb --image OUT/b.exr --image OUT/b.png --json OUT/b.json "
      "--passes 2 --quiet",
      "psf filter IN/a.pvb -o OUT/f.exr -o OUT/f.png --json OUT/f.json --quiet",
      "psf info IN/a.pvb --stats --json OUT/i.json",
      "psf verify IN/a.pvb --json OUT/v.json",
      "psf recover IN/a.pvb OUT/r.pvb --json OUT/r.json",
      "psf cat IN/a.pvb IN/a.pvb -o OUT/c.pvb --json OUT/c.json --quiet",
      "psf export IN/a.pvb -o OUT/e.csv --json OUT/e.json",
      "psf export IN/a.pvb -o OUT/e.ply --json OUT/e.json",
      "psf export IN/a.pvb -o OUT/arrays --json OUT/e.json",
      "psf export IN/a.pvb -o OUT/oidn --for oidn --json OUT/e.json --quiet",
      "psf export IN/a.pvb -o OUT/nfor --for nfor --json OUT/e.json --quiet",
      "psf export IN/a.pvb -o OUT/bcd --for bcd --json OUT/e.json --quiet",
      "psf compare IN/a.exr IN/a.exr --error OUT/d.exr --error OUT/d.png --json OUT/d.json",
      "psf flicker IN/s.####.exr IN/s.####.exr --reference IN/s.####.exr --sheet OUT/k.png --json "
      "OUT/k.json --quiet",
      "psf relight IN/a.exr sky=2,1,0.5 -o OUT/l.exr -o OUT/l.png --json OUT/l.json",
      "psf sweep IN/a.pvb --reference IN/a.exr --r0 4px,8px --pictures -o OUT/sweep --json "
      "OUT/s.json",
      "psf converge IN/a.pvb --reference IN/a.exr --r0 4px,8px --pictures -o OUT/converge --json "
      "OUT/g.json",
      "psf tune IN/a.pvb --r0 4px,8px --block 1pass --json OUT/t.json",
      "psf ablate IN/a.pvb --reference IN/a.exr -o OUT/a.png -o OUT/ablate --json OUT/a.json "
      "--quiet",
      "psf explain IN/a.pvb --pixel 8,6 --json OUT/x.json --ply OUT/x.ply",
      "psf report IN/sweep -o OUT/r.html --json OUT/h.json"};
  return verbs;
}

// One line, of the program itself.
inline bool is_one_line(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n') == 1 && text.starts_with("psf");
}

}  // namespace psf::tests
