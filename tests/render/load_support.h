// What the tests of the loaders share: a folder that goes again, files written into it, errors
// caught.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "catch.h"
#include "core/error.h"
#include "render/scene/load.h"

namespace psf::render {

class TempFolder {
 public:
  TempFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "psf-load-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  // Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path path = std::filesystem::path(path_) / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
    return path.string();
  }

 private:
  std::string path_;
};

struct Failure {
  ErrorCode code{};
  std::string message;  // the folder in front is cut off
};

// The error of loading `path`; an empty message where it loads.
inline Failure load_failure(const std::string& path, const SceneOverrides& overrides = {},
                            const Moment& moment = {}, bool rest = false) {
  try {
    (void)load_scene(path, overrides, moment, rest);
  } catch (const Error& error) {
    std::string message = error.what();
    const std::string folder = std::filesystem::path(path).parent_path().string() + "/";
    for (std::size_t at = message.find(folder); at != std::string::npos;
         at = message.find(folder)) {
      message.erase(at, folder.size());
    }
    return {error.code(), message};
  }
  return {};
}

// To within the roundings of a loader.
inline void check_point(const Vec3& got, const Vec3& expected) {
  for (int c = 0; c < 3; ++c) CHECK(double{got[c]} == Approx(double{expected[c]}).margin(1e-5));
}
inline void check_color(const Rgb& got, const Rgb& expected, double margin = 1e-4) {
  for (int c = 0; c < 3; ++c) CHECK(double{got[c]} == Approx(double{expected[c]}).margin(margin));
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// A JSON scene of the materials "white" and "lamp" and of these shapes.
inline std::string with_shapes(const std::string& shapes) {
  return R"({"materials": [{"name": "white"}, {"name": "lamp", "emission": [1, 2, 3]}],
      "shapes": [)" +
         shapes + "]}";
}

// A picture of one row in a plain text format: "r g b r g b ...".
inline std::string ppm(int width, const std::string& values) {
  return "P3\n" + std::to_string(width) + " 1\n255\n" + values + "\n";
}

}  // namespace psf::render
