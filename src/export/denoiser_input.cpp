#include "export/denoiser_input.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "core/error.h"
#include "export/file.h"

namespace psf::exports {

void PictureFolder::write_exr(const std::string& name, film::Image image) {
  const std::string path = folder_.temporary(inside_ + name);
  files_.push_back(folder_.shown(inside_ + name));
  image.attributes = attributes_;
  try {
    film::write_exr(path, image);
  } catch (const Error& error) {
    // Nobody knows the hidden name.
    std::string message = error.what();
    if (message.starts_with(path)) message.replace(0, path.size(), files_.back());
    throw Error(error.code(), message);
  }
  bytes_ += std::filesystem::file_size(path);
}

// Debevec's format: a header of three lines, rows from the bottom, the sign of the last number
// tells the order of the bytes.
void PictureFolder::write_pfm(const std::string& name, std::size_t width, std::size_t height,
                              std::span<const float> rgb) {
  const std::string path = folder_.temporary(inside_ + name);
  files_.push_back(folder_.shown(inside_ + name));
  ExportFile file(path, files_.back());
  file.write(fmt::format("PF\n{} {}\n-1.0\n", width, height));
  for (std::size_t y = height; y-- > 0;) {
    file.write(std::as_bytes(rgb.subspan(3 * width * y, 3 * width)));
  }
  file.close();
  bytes_ += file.bytes();
}

void PictureFolder::write_text(const std::string& name, const std::string& text) {
  const std::string path = folder_.temporary(inside_ + name);
  files_.push_back(folder_.shown(inside_ + name));
  ExportFile file(path, files_.back());
  file.write(text);
  file.close();
  bytes_ += file.bytes();
}

}  // namespace psf::exports
