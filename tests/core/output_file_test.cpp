// An output appears under its name only when whole.
#include "core/output_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "catch.h"
#include "core/error.h"
#include "read_text.h"
#include "temp_folder.h"

using psf::core::OutputFile;
using psf::tests::TempFolder;

namespace {}  // namespace

TEST_CASE("a file that is not committed leaves what was there before, and nothing else") {
  const TempFolder folder;
  const std::string path = folder / "out.txt";
  psf::core::write_text_file(path, "old");
  {
    OutputFile file(path);
    std::ofstream(file.temporary_path()) << "half";
  }
  CHECK(psf::tests::read_text(path) == "old");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("a committed file replaces the old one whole") {
  const TempFolder folder;
  const std::string path = folder / "out.txt";
  psf::core::write_text_file(path, "old");
  psf::core::write_text_file(path, "new");
  CHECK(psf::tests::read_text(path) == "new");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("the temporary keeps the extension, by which libraries choose the format") {
  const TempFolder folder;
  const OutputFile file(folder / "picture.exr");
  CHECK(file.temporary_path().ends_with(".exr"));
}

TEST_CASE("a missing folder, a folder as file name and an empty name are told at once") {
  const TempFolder folder;
  for (const std::string& path :
       {folder / "nowhere/out.exr", folder.path().string(), std::string()}) {
    try {
      OutputFile file(path);
      FAIL("no error for \"" << path << '"');
    } catch (const psf::Error& error) {
      CHECK(error.code() == psf::ErrorCode::io);
      CHECK(std::string(error.what()).starts_with(path));
    }
  }
  CHECK(folder.file_count() == 0);
}

TEST_CASE("a full disk is an error, not a short file") {
  CHECK_THROWS_AS(psf::core::write_text_file("/dev/full", "text"), psf::Error);
}

TEST_CASE("unfinished folders go with what is in them, inner ones too") {
  const TempFolder folder;
  const std::string outer = folder / "outer", inner = outer + "/inner", file = inner + "/file";
  const psf::core::Unfinished a(outer), b(inner), c(file);
  std::filesystem::create_directories(inner);
  std::ofstream(file) << "half";
  psf::core::remove_unfinished();
  CHECK(folder.file_count() == 0);
}
