// A disk that is full, for real: a tiny tmpfs in a name space of its own.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "catch.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

// How mounts of our own are had: as a user by a name space of users, which a chroot does not allow.
const std::string& unshare() {
  static const std::string command =
      std::system("unshare -rm true 2>/dev/null") == 0 ? "unshare -rm" : "unshare -m";
  return command;
}

// Runs `commands` with a disk of `kilobytes` mounted on `folder`. The exit code.
int on_small_disk(std::size_t kilobytes, const std::string& folder, const std::string& commands) {
  const std::string script =
      fmt::format("mount -t tmpfs -o size={}k none '{}' && cd '{}' && {{ {}; }}", kilobytes, folder,
                  folder, commands);
  const int status =
      std::system(fmt::format("{} sh -c \"{}\" 2>/dev/null", unshare(), script).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_CASE("a disk that is full is an error with a remedy, and the last commit is readable") {
  const test::Scratch scratch;
  const std::string disk = scratch.path("disk"), kept = scratch.path("kept");
  std::filesystem::create_directories(disk);
  std::filesystem::create_directories(kept);
  if (on_small_disk(64, disk, "true") != 0) {
    SKIP("no disk can be mounted here (unshare -rm or -m, mount -t tmpfs)");
  }
  std::size_t cases = 0, full = 0;
  std::uint64_t most = 0;
  for (const char* codec : {"raw", "zstd"}) {
    for (std::size_t kilobytes = 4; kilobytes <= 128; kilobytes += 4) {
      CAPTURE(codec, kilobytes);
      std::filesystem::remove_all(kept);
      std::filesystem::create_directories(kept);
      // The writer, then a second one that goes on where the first had to stop.
      const std::string writer =
          fmt::format("{}/psf_numbered_writer a.pvb {} 5 0 sync close", PSF_BINARY_DIR, codec);
      const int code = on_small_disk(
          kilobytes, disk,
          fmt::format("{0} >'{1}/told' 2>'{1}/error'; code=\\$?; cp a.pvb* '{1}'; exit \\$code",
                      writer, kept));
      ++cases;
      const std::string file = kept + "/a.pvb";
      CHECK_FALSE(std::filesystem::exists(file + ".partial"));
      if (code == 0) {
        CHECK(test::holds_passes(Reader(file), 5));
        continue;
      }
      ++full;
      CHECK(code == 4);
      const test::Bytes said = test::load(kept + "/error");
      const std::string text(reinterpret_cast<const char*>(said.data()), said.size());
      CHECK(text.find("a.pvb") == 0);
      CHECK(text.find("No space left on device; free some space") != std::string::npos);
      CHECK(std::count(text.begin(), text.end(), '\n') == 1);
      const test::Bytes told = test::load(kept + "/told");
      const std::uint64_t passes = std::strtoull(
          std::string(reinterpret_cast<const char*>(told.data()), told.size()).substr(6).c_str(),
          nullptr, 10);
      if (passes == 0) {
        CHECK_FALSE(std::filesystem::exists(file));
        continue;
      }
      most = std::max(most, passes);
      CHECK(test::holds_passes(Reader(file), passes));
      CHECK(check(file).faults.empty());
      // With room it goes on.
      {
        Writer again = Writer::resume(file, test::numbered_head(), {Codec::raw, false, {}});
        test::write_numbered(again, 5);
      }
      CHECK(test::holds_passes(Reader(file), 5));
    }
  }
  CAPTURE(cases, full, most);
  CHECK(cases == 64);
  CHECK(full > 20);
  CHECK(full < cases);
  CHECK(most >= 3);
}
