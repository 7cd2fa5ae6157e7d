// A folder of results goes again with what was written into it, and with nothing else.
#include "core/new_folder.h"

#include <filesystem>
#include <fstream>

#include "catch.h"
#include "core/error.h"
#include "read_text.h"
#include "temp_folder.h"

namespace fs = std::filesystem;
using psf::core::NewFolder;
using psf::tests::TempFolder;

namespace {

void fill(NewFolder& folder, const std::string& path) {
  std::ofstream(path) << "half";
  folder.add(path);
}

}  // namespace

TEST_CASE("a new folder that is not kept goes with its files and the folders made above it") {
  const TempFolder temp;
  for (const std::string end : {"", "/"}) {
    {
      NewFolder folder(temp / "a/b" + end);
      CHECK(fs::is_directory(temp / "a/b"));
      fill(folder, temp / "a/b/1.exr");
      fill(folder, temp / "a/b/2.exr");
    }
    CHECK(temp.file_count() == 0);
  }
}

TEST_CASE("a new folder that is kept stays with its files") {
  const TempFolder temp;
  {
    NewFolder folder(temp / "a/b");
    fill(folder, temp / "a/b/1.exr");
    folder.keep();
  }
  CHECK(psf::tests::read_text(temp / "a/b/1.exr") == "half");
}

TEST_CASE("what was there before a run, or came from others, stays") {
  const TempFolder temp;
  fs::create_directory(temp / "empty");
  {
    NewFolder folder(temp / "empty");
    fill(folder, temp / "empty/1.exr");
  }
  CHECK(fs::is_empty(temp / "empty"));
  {
    NewFolder folder(temp / "new");
    fill(folder, temp / "new/1.exr");
    std::ofstream(temp / "new/mine.txt") << "mine";
  }
  CHECK_FALSE(fs::exists(temp / "new/1.exr"));
  CHECK(psf::tests::read_text(temp / "new/mine.txt") == "mine");
}

TEST_CASE("a folder that cannot be made is an error, and nothing is left of it") {
  const TempFolder temp;
  std::ofstream(temp / "file") << "text";
  CHECK_THROWS_AS(NewFolder(temp / "file/b"), psf::Error);
  CHECK(psf::tests::read_text(temp / "file") == "text");
}
