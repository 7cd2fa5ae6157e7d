// Every file of the corpus, and every input that ever crashed, keeps all promises.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "catch.h"
#include "read_text.h"
#include "targets.h"

using namespace psf;

namespace {

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void replay(const fuzz::Target& target, const std::filesystem::path& folder) {
  for (const auto& file : files_of(folder)) {
    CAPTURE(file.string());
    const std::string bytes = psf::tests::read_text(file);
    CHECK_NOTHROW(target.run(std::as_bytes(std::span(bytes))));
  }
}

// Whole files go through both targets that take them.
std::vector<std::string> sources_of(const std::string& target) {
  if (target == "open" || target == "recover") return {"open", "recover"};
  return {target};
}

void replay_all(const std::string& kind, std::size_t least) {
  const std::filesystem::path folder = std::filesystem::path(PSF_SOURCE_DIR) / "tests/formats/fuzz";
  for (const fuzz::Target& target : fuzz::kTargets) {
    for (const std::string& source : sources_of(target.name)) {
      const auto files = folder / kind / source;
      if (kind == "crashes" && !std::filesystem::is_directory(files)) continue;
      CHECK(files_of(files).size() >= least);
      replay(target, files);
    }
  }
}

}  // namespace

TEST_CASE("the corpus of every target keeps all promises") {
  replay_all("corpus", 6);
}

TEST_CASE("what once crashed a target no longer does") {
  replay_all("crashes", 1);
}
