// PNG through OpenImageIO: 8 bits, tone-mapped, sRGB.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <cstdint>
#include <memory>

#include "core/error.h"
#include "core/output_file.h"
#include "film/display.h"
#include "film/image.h"

namespace psf::film {

void write_png(const std::string& path, const Image& image, float exposure) {
  const std::vector<Rgb> colors = image.rgb();
  const float scale = std::exp2(exposure);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * colors.size());
  for (const Rgb& color : colors) {
    for (const float component : {color.x, color.y, color.z}) {
      const float shown = srgb_from_linear(tone_map(component * scale));
      bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * shown)));
    }
  }
  core::OutputFile file(path);
  OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3,
                       OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  const auto output = OIIO::ImageOutput::create("png");
  if (!output || !output->open(file.temporary_path(), spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) || !output->close()) {
    throw Error(ErrorCode::io, path + ": cannot write the picture: " +
                                   (output ? output->geterror() : OIIO::geterror()));
  }
  file.commit();
}

}  // namespace psf::film
