// Writes the pictures of a run of psf filter.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/interrupt.h"
#include "core/seconds.h"
#include "film/image.h"
#include "film/picture_names.h"
#include "filter_frames.h"
#include "run/attributes.h"
#include "run/filter_dump.h"
#include "version.h"

namespace psf::tools {

inline std::vector<std::string> camera_names(const run::Dump& dump) {
  std::vector<std::string> names;
  for (const formats::CameraInfo& camera : dump.metadata().cameras) names.push_back(camera.name);
  return names;
}

// Writes the pictures of a run, every camera under every name.
class PictureWriter {
 public:
  PictureWriter(const FrameRun& of, const run::FilterRequest& run)
      : names_(of.outputs, camera_names(*of.frame.dump)),
        attributes_(run::attributes_of(kVersion, *of.frame.dump, run)),
        cameras_(of.frame.dump->metadata().cameras),
        first_(run.passes.first) {}

  // The files that all pictures of a run go to.
  static std::vector<std::string> files_of(const FrameRun& of,
                                           const std::vector<std::uint64_t>& snapshots) {
    const film::PictureNames names(of.outputs, camera_names(*of.frame.dump));
    return names.all(snapshots);
  }

  // Writes the pictures of the first `passes` passes and returns their names. `snapshot`: number
  // for the names; 0: the final pictures.
  std::vector<std::string> write(std::uint64_t snapshot, std::uint64_t passes,
                                 std::span<const run::CameraPictures> pictures) {
    const auto start = core::Clock::now();
    std::vector<std::string> written;
    for (std::size_t camera = 0; camera < pictures.size(); ++camera) {
      film::Image image = pictures[camera].image();
      image.attributes.insert(image.attributes.begin(), attributes_.begin(), attributes_.end());
      film::add_picture(image.attributes, cameras_[camera].name, first_, first_ + passes);
      for (std::size_t output = 0; output < names_.count(); ++output) {
        core::throw_if_interrupted("not all pictures were written");
        written.push_back(names_.path(output, camera, snapshot));
        film::write_image(written.back(), image);
      }
    }
    seconds_ += core::seconds_since(start);
    return written;
  }
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  film::PictureNames names_;
  film::Attributes attributes_;
  std::vector<formats::CameraInfo> cameras_;
  std::size_t first_;
  double seconds_ = 0;
};

}  // namespace psf::tools
