// EXR through OpenEXR: single-part, scanline, float32.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <exception>
#include <filesystem>

#include "core/error.h"
#include "core/output_file.h"
#include "film/image.h"

namespace psf::film {
namespace {

// OpenEXR takes (and never writes through) a non-const base pointer.
Imf::Slice slice(const std::vector<float>& values, std::size_t width) {
  char* base = reinterpret_cast<char*>(const_cast<float*>(values.data()));
  return {Imf::FLOAT, base, sizeof(float), sizeof(float) * width};
}

}  // namespace

void write_exr(const std::string& path, const Image& image) {
  core::OutputFile file(path);
  try {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, value] : image.attributes) {
      header.insert(name, Imf::StringAttribute(value));
    }
    Imf::FrameBuffer buffer;
    for (const Layer& layer : image.layers) {
      header.channels().insert(layer.channel, Imf::Channel(Imf::FLOAT));
      buffer.insert(layer.channel, slice(layer.values, image.width));
    }
    Imf::OutputFile output(file.temporary_path().c_str(), header);
    output.setFrameBuffer(buffer);
    output.writePixels(static_cast<int>(image.height));
  } catch (const std::exception& error) {
    throw Error(ErrorCode::io, path + ": cannot write the picture: " + error.what());
  }
  file.commit();
}

Image read_exr(const std::string& path) {
  if (!std::filesystem::exists(path)) {
    throw Error(ErrorCode::io, path + ": no such file");
  }
  try {
    Imf::InputFile input(path.c_str());
    const Imath::Box2i window = input.header().dataWindow();
    Image image;
    image.path = path;
    image.width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    image.height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
    Imf::FrameBuffer buffer;
    const Imf::ChannelList& channels = input.header().channels();
    // The slices point into the layers, so all layers are made before any slice.
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
      image.layers.push_back({channel.name(), std::vector<float>(image.width * image.height)});
    }
    for (const Layer& layer : image.layers) {
      Imf::Slice target = slice(layer.values, image.width);
      const auto origin =
          static_cast<std::ptrdiff_t>(window.min.x) +
          static_cast<std::ptrdiff_t>(window.min.y) * static_cast<std::ptrdiff_t>(image.width);
      target.base -= origin * static_cast<std::ptrdiff_t>(sizeof(float));
      buffer.insert(layer.channel, target);
    }
    input.setFrameBuffer(buffer);
    input.readPixels(window.min.y, window.max.y);
    for (auto at = input.header().begin(); at != input.header().end(); ++at) {
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&at.attribute())) {
        image.attributes.emplace_back(at.name(), text->value());
      }
    }
    return image;
  } catch (const std::exception& error) {
    throw Error(ErrorCode::bad_input, path + ": no readable EXR picture: " + error.what());
  }
}

}  // namespace psf::film
