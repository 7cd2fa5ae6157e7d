// No output is an input or another output, whatever names lead to it.
#include "core/apart.h"

#include <filesystem>
#include <string>
#include <vector>

#include "catch.h"
#include "core/error.h"
#include "core/output_file.h"
#include "temp_folder.h"

namespace fs = std::filesystem;
using psf::tests::TempFolder;

namespace {

using Names = std::vector<std::string>;

bool refused(const Names& inputs, const Names& outputs) {
  try {
    psf::core::check_apart(inputs, outputs);
    return false;
  } catch (const psf::Error& error) {
    CHECK(error.code() == psf::ErrorCode::usage);
    return true;
  }
}

}  // namespace

TEST_CASE("every name of a file is known for it") {
  const TempFolder folder;
  fs::create_directories(folder / "sub/deep");
  psf::core::write_text_file(folder / "a", "text");
  psf::core::write_text_file(folder / "other", "text");
  fs::create_symlink("a", folder / "link");
  fs::create_symlink("link", folder / "link-to-link");
  fs::create_directory_symlink("sub", folder / "folder-link");
  fs::create_symlink("../a", folder / "sub/up");
  fs::create_hard_link(folder / "a", folder / "hard");
  fs::create_symlink("missing", folder / "dangling");
  const Names same = {"a",          "./a",           "sub/../a",  "sub/deep/../../a", "link",
                      "sub/up",     "hard",          "sub//../a", "link-to-link",     "sub/./up",
                      "./././hard", "folder-link/up"};
  for (const std::string& name : same) {
    INFO(name);
    CHECK(refused({folder / "a"}, {folder / name}));
    CHECK(refused({folder / name}, {folder / "other", folder / "a"}));
    CHECK(refused({}, {folder / "a", "", folder / name}));
    CHECK_FALSE(refused({folder / name}, {folder / "other"}));
  }
  // The same holds for files and folders that do not exist.
  for (const auto& [one, other] :
       {std::pair{"missing", "./missing"}, std::pair{"missing", "dangling"},
        std::pair{"sub/new", "folder-link/new"}, std::pair{"sub/new", "sub/deep/../new"},
        std::pair{"new/x", "./new/x"}, std::pair{"new/x", "sub/../new/x"},
        std::pair{"newfolder", "newfolder/"}}) {
    INFO(one << " and " << other);
    CHECK(refused({}, {folder / one, folder / other}));
  }
  CHECK_FALSE(refused({}, {folder / "new/x", folder / "new/y", folder / "x", folder / "y"}));
  CHECK_FALSE(refused({folder / "a", folder / "hard", folder / "a"}, {folder / "other"}));
}

TEST_CASE("names relative to the folder that one is in are known") {
  const TempFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  const bool missing = refused({}, {"a", folder / "a"});
  psf::core::write_text_file("a", "text");
  const bool there = refused({"a"}, {folder / "a"});
  fs::current_path(before);
  CHECK(missing);
  CHECK(there);
}

TEST_CASE("devices and pipes may be read and written at once") {
  CHECK_FALSE(refused({"/dev/null"}, {"/dev/null", "/dev/null", "/dev/full"}));
}
