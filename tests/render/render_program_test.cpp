// psf-render as a program: ^C, and paths that are refused before anything is rendered.
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <thread>
#include <vector>

#include "catch.h"
#include "core/output_file.h"
#include "formats/layout/metadata.h"
#include "formats/read/reader.h"
#include "temp_folder.h"

using namespace psf;
using psf::tests::TempFolder;

namespace {

using namespace std::chrono_literals;

// Starts psf-render, on the Cornell box unless told, its streams closed off.
pid_t start(std::vector<std::string> arguments,
            const std::string& scene = PSF_SOURCE_DIR "/sample_data/cornell.json") {
  arguments.insert(arguments.begin(), {PSF_BINARY_DIR "/psf-render", scene});
  const pid_t child = fork();
  if (child != 0) return child;
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  if (std::freopen("/dev/null", "w", stdout) == nullptr ||
      std::freopen("/dev/null", "w", stderr) == nullptr) {
    _exit(99);
  }
  execv(argv[0], argv.data());
  _exit(99);
}

int wait_for(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Waits until `condition` holds. False after ten minutes, which the busiest machine does not take.
template <class Condition>
bool eventually(Condition condition) {
  for (int k = 0; k < 60'000; ++k) {
    if (condition()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

}  // namespace

TEST_CASE("^C ends after the pass, with exit code 130 and a file of whole passes") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  const pid_t child =
      start({"-o", path, "--size", "64x48", "--passes", "1000000", "--image", folder / "a.png"});
  REQUIRE(eventually([&] { return std::filesystem::exists(path); }));
  kill(child, SIGINT);
  CHECK(wait_for(child) == 130);
  const formats::Reader reader(path);
  CHECK(reader.records() > 0);
  CHECK(reader.records() % (64 * 48) == 0);
  CHECK(reader.uncommitted_bytes() == 0);
  CHECK_FALSE(reader.closed());
  CHECK(folder.file_count() == 2);  // the dump, and the picture of the passes done
}

TEST_CASE("^C ends a pass that would take minutes within seconds, and leaves no file of none") {
  const TempFolder folder;
  const pid_t child = start({"-o", folder / "a.pvb", "--image", folder / "a.png", "--size",
                             "2048x2048", "--split", "64"});
  REQUIRE(eventually([&] { return folder.file_count() > 0; }));
  std::this_thread::sleep_for(200ms);
  kill(child, SIGINT);
  int status = 0;
  bool ended = false;
  for (int k = 0; k < 300 && !ended; ++k) {
    std::this_thread::sleep_for(100ms);
    ended = waitpid(child, &status, WNOHANG) == child;
  }
  CHECK(ended);
  if (!ended) kill(child, SIGKILL);
  if (!ended) waitpid(child, &status, 0);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 130);
  CHECK(folder.file_count() == 0);
}

TEST_CASE("a second ^C ends at once") {
  const TempFolder folder;
  const pid_t child = start({"-o", folder / "a.pvb", "--size", "2048x2048", "--split", "64"});
  REQUIRE(eventually([&] { return folder.file_count() > 0; }));
  std::this_thread::sleep_for(200ms);
  kill(child, SIGINT);
  std::this_thread::sleep_for(200ms);
  int status = 0;
  CHECK(waitpid(child, &status, WNOHANG) == 0);  // goes on with its pass
  kill(child, SIGINT);
  CHECK(wait_for(child) == 128 + SIGINT);
  CHECK_FALSE(std::filesystem::exists(folder / "a.pvb"));
}

TEST_CASE("outputs that cannot be written are refused before rendering, nothing is left behind") {
  const TempFolder folder;
  const std::string many = "1000000";
  CHECK(wait_for(start({"--passes", many})) == 2);
  CHECK(wait_for(start({"--passes", many, "-o", folder / "none/a.pvb"})) == 4);
  CHECK(wait_for(start(
            {"--passes", many, "-o", folder / "a.pvb", "--image", folder / "none/a.png"})) == 4);
  CHECK(wait_for(start({"--passes", many, "-o", folder / "a.pvb", "--image", folder / "a.gif"})) ==
        2);
  CHECK(wait_for(start(
            {"--passes", many, "-o", folder / "a.pvb", "--json", folder / "none/a.json"})) == 4);
  CHECK(wait_for(start({"--passes", many, "-o", folder / "a.pvb", "--camera", "nobody"})) == 2);
  CHECK(wait_for(start({"--passes", many, "-o", folder / "a.pvb", "--eye", "1,2"})) == 2);
  CHECK(wait_for(start({"--passes", many, "-o", folder / "a.pvb", "--size", "0x4"})) == 2);
  CHECK(folder.file_count() == 0);
}

TEST_CASE("with several cameras pictures get their names, and --json the figures") {
  const TempFolder folder;
  core::write_text_file(folder / "two.json", R"({
      "cameras": [{"name": "near", "eye": [0, 0, 3], "target": [0, 0, 0], "size": [24, 16]},
                  {"name": "a/b", "eye": [0, 0, 9], "target": [0, 0, 0], "size": [10, 12]}],
      "materials": [{"name": "grey", "reflectance": 0.5}],
      "environment": {"radiance": [1, 1, 1]},
      "shapes": [{"shape": "sphere", "material": "grey", "center": [0, 0, 0], "radius": 1}]})");
  const auto run = [&](const std::vector<std::string>& cameras, const std::string& name) {
    std::vector<std::string> arguments{
        "-o",      folder / (name + ".pvb"), "--passes", "2",
        "--image", folder / (name + ".png"), "--json",   folder / (name + ".txt")};
    for (const std::string& camera : cameras)
      arguments.insert(arguments.end(), {"--camera", camera});
    return wait_for(start(arguments, folder / "two.json"));
  };
  const auto exists = [&](const std::string& name) {
    return std::filesystem::exists(folder / name);
  };
  CHECK(run({"all"}, "all") == 0);
  CHECK(exists("all.near.png"));
  CHECK(exists("all.a_b.png"));
  CHECK(exists("all.txt"));
  CHECK(formats::Reader(folder / "all.pvb").records() == 2 * (24 * 16 + 10 * 12));
  CHECK(run({"a/b"}, "second") == 0);
  CHECK(exists("second.png"));
  CHECK(formats::Reader(folder / "second.pvb").records() == 2 * 10 * 12);
  CHECK(run({}, "first") == 0);
  CHECK(formats::Reader(folder / "first.pvb").records() == 2 * 24 * 16);
}

TEST_CASE("a colour of the command line may be one number, for grey") {
  const TempFolder folder;
  const auto hash = [&](const std::vector<std::string>& light) {
    const std::string path = folder / "a.pvb";
    std::vector<std::string> arguments = {"-o", path, "--size", "2x2", "--passes", "1", "--quiet"};
    arguments.insert(arguments.end(), light.begin(), light.end());
    std::filesystem::remove(path);
    REQUIRE(wait_for(start(arguments)) == 0);
    return formats::parse_metadata(formats::Reader(path).head().metadata).scene_hash;
  };
  CHECK(hash({"--sky", "0.5"}) == hash({"--sky", "0.5,0.5,0.5"}));
  CHECK(hash({"--sky", "0.5"}) != hash({"--sky", "0.25"}));
  CHECK(hash({"--sun-irradiance", "2"}) == hash({"--sun-irradiance", "2,2,2"}));
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {"--sky", "-1"}, {"--sky", "1,2"}, {"--sun-irradiance", "-1"}, {"--eye", "1"}}) {
    std::vector<std::string> arguments = {"-o", folder / "b.pvb"};
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    CHECK(wait_for(start(arguments)) == 2);
  }
}
