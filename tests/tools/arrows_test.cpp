// The arrows between the folders are those of src/README.md, in includes, links and symbols; psf
// links neither Embree nor OpenImageIO.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "catch.h"
#include "command.h"

namespace fs = std::filesystem;

namespace {

const fs::path kRoot = PSF_SOURCE_DIR;

// Which folders the files of a folder may include and its library may link; itself always.
const std::map<std::string, std::set<std::string>> kAllowed = {
    {"core", {}},
    {"formats", {"core"}},
    {"search", {"core"}},
    {"film", {"core"}},
    {"filter", {"core", "search"}},
    {"run", {"core", "filter", "film", "formats"}},
    {"metrics", {"core", "film"}},
    {"export", {"core", "film", "formats", "run"}},
    {"explain", {"core", "export", "filter", "formats", "run", "search"}},
    {"study", {"core", "filter", "film", "formats", "metrics", "run"}},
    {"psf", {"core", "explain", "film", "filter", "formats", "metrics", "run", "study"}},
    {"python", {"core", "psf", "render"}},
    {"report", {"core", "film", "metrics", "run", "study"}},
    {"render", {"core", "film", "formats"}},
};

fs::path path_of(const std::string& folder) {
  return folder == "formats" ? kRoot / folder : kRoot / "src" / folder;
}

using Folders = std::map<std::string, std::string>;  // each with where it was found

// The other folders of ours whose headers the files of a folder include.
Folders folders_included(const std::string& folder) {
  const std::regex include("^\\s*#include\\s+\"([a-z]+)/[^\"]+\"");
  Folders folders;
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(path_of(folder))) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    ++files;
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (!std::regex_search(line, match, include) || match[1] == folder) continue;
      folders.emplace(match[1], entry.path().string() + ": " + line);
    }
  }
  REQUIRE(files > 0);
  return folders;
}

// The other folders of ours whose functions a library calls, also by headers of a third one.
Folders folders_called(const std::string& folder, const std::string& archive) {
  std::istringstream symbols(psf::tests::run("nm --undefined-only --demangle " + archive).out);
  const std::regex call("^ +U psf::([a-z]+)::");
  Folders folders;
  for (std::string line; std::getline(symbols, line);) {
    std::smatch match;
    if (!std::regex_search(line, match, call)) continue;
    // A namespace cannot be called export.
    const std::string called = match[1] == "exports" ? "export" : match[1].str();
    if (called != folder) folders.emplace(called, line);
  }
  return folders;
}

void check_within(const Folders& found, const std::set<std::string>& allowed) {
  for (const auto& [folder, where] : found) {
    INFO(where);
    CHECK(allowed.contains(folder));
  }
}

}  // namespace

TEST_CASE("every include of a folder follows the arrows") {
  for (const auto& [folder, allowed] : kAllowed) check_within(folders_included(folder), allowed);
}

TEST_CASE("every library links what it includes and calls, and nothing beside its arrows") {
  std::ifstream in(PSF_BINARY_DIR "/../links.txt");
  std::size_t libraries = 0, called = 0;
  std::string folder, archive, linked_by_cmake;
  while (in >> folder >> archive >> linked_by_cmake) {
    ++libraries;
    INFO(folder << " links " << linked_by_cmake);
    std::set<std::string> linked;
    const std::regex name("psf::([a-z]+)");
    for (std::sregex_iterator at(linked_by_cmake.begin(), linked_by_cmake.end(), name), end;
         at != end; ++at) {
      linked.insert((*at)[1]);
      CHECK(kAllowed.at(folder).contains((*at)[1]));
    }
    check_within(folders_included(folder), linked);
    const Folders calls = folders_called(folder, archive);
    check_within(calls, linked);
    called += calls.size();
  }
  CHECK(libraries + 2 == kAllowed.size());  // psf and python are loaded, not linked
  CHECK(called >= libraries - 1);           // all but core call another
}

// Folders within a library: each may include those before it.
TEST_CASE("no file of a library includes a folder above its own") {
  const std::map<std::string, std::vector<std::string>> layers = {
      {"formats", {"layout", "read", "write", "check"}},
      {"render", {"sample", "scene", "accel", "light", "camera", "loop", "job"}}};
  for (const auto& [library, order] : layers) {
    const std::regex include("^#include \"" + library + "/([a-z]+)/");
    const auto layer = [&order = order](const std::string& folder) {
      return std::find(order.begin(), order.end(), folder) - order.begin();
    };
    std::size_t included = 0;
    for (const auto& entry : fs::recursive_directory_iterator(path_of(library))) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      const std::string own = fs::relative(entry.path(), path_of(library)).begin()->string();
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) {
        std::smatch match;
        if (!std::regex_search(line, match, include)) continue;
        ++included;
        INFO(entry.path().string() << ": " << line);
        CHECK(layer(match[1]) <= layer(own));
        CHECK(layer(match[1]) < std::ssize(order));
      }
    }
    CHECK(included > 20);
  }
}

TEST_CASE("every folder of the source has its arrows here") {
  for (const auto& entry : fs::directory_iterator(kRoot / "src")) {
    if (entry.is_directory()) CHECK(kAllowed.contains(entry.path().filename().string()));
  }
}

// OpenImageIO takes half a gigabyte of addresses and more time to load than many a verb to run.
TEST_CASE("psf links neither Embree nor OpenImageIO, psf-render links both") {
  const std::string psf = psf::tests::run("ldd " PSF_BINARY_DIR "/psf").out;
  const std::string render = psf::tests::run("ldd " PSF_BINARY_DIR "/psf-render").out;
  for (const char* library : {"libembree", "libOpenImageIO"}) {
    INFO(library);
    CHECK(psf.find(library) == std::string::npos);
    CHECK(render.find(library) != std::string::npos);
  }
}

TEST_CASE("JSON becomes text and remarks go out in one place each") {
  for (const char* folder : {"src", "tools"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      const std::string name = entry.path().filename().string();
      const std::string text = psf::tests::read_text(entry.path().string());
      INFO(entry.path().string());
      // A value's own dump() throws for what is no UTF-8, {fmt} where stderr takes no more.
      const bool dumps = std::regex_search(text, std::regex("[a-z_\\])]\\.dump\\("));
      CHECK((!dumps || name == "json_text.h" || entry.path().parent_path().filename() == "json"));
      CHECK(text.find("print(stderr") == std::string::npos);
    }
  }
}
