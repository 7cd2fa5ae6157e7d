// The names of the files that a run writes its pictures to, one for each output, camera and
// snapshot.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace psf::film {

// Makes file names from the given names, the camera's name where there are several cameras, and the
// number of passes of a snapshot.
class PictureNames {
 public:
  PictureNames(const std::vector<std::string>& names, const std::vector<std::string>& cameras)
      : names_(names) {
    std::set<std::string> taken;
    for (std::string name : cameras) {
      if (name.empty()) name = "camera";
      std::replace_if(
          name.begin(), name.end(),
          [](unsigned char c) { return c < 0x80 && std::isalnum(c) == 0 && c != '-'; }, '_');
      const std::string stem = name;
      for (int k = 2; !taken.insert(name).second; ++k) name = stem + std::to_string(k);
      cameras_.push_back(cameras.size() > 1 ? "." + name : "");
    }
  }

  // The file for an output, a camera and the snapshot after `passes` passes; 0: the final picture.
  [[nodiscard]] std::string path(std::size_t output, std::size_t camera,
                                 std::uint64_t passes) const {
    const std::filesystem::path name(names_[output]);
    const std::string suffix = passes == 0 ? "" : fmt::format(".{:04}", passes);
    return (name.parent_path() /
            (name.stem().string() + cameras_[camera] + suffix + name.extension().string()))
        .string();
  }
  // The names of all files of a run with these snapshots.
  [[nodiscard]] std::vector<std::string> all(const std::vector<std::uint64_t>& snapshots) const {
    std::vector<std::string> files;
    for (std::size_t output = 0; output < names_.size(); ++output) {
      for (std::size_t camera = 0; camera < cameras_.size(); ++camera) {
        files.push_back(path(output, camera, 0));
        for (const std::uint64_t passes : snapshots) files.push_back(path(output, camera, passes));
      }
    }
    return files;
  }
  [[nodiscard]] std::size_t count() const { return names_.size(); }

 private:
  std::vector<std::string> names_, cameras_;
};

}  // namespace psf::film
