// Every channel of an EXR of ours.
#include <IexErrnoExc.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>

#include <exception>
#include <new>
#include <string>

#include "core/error.h"
#include "film/exr_check.h"
#include "film/image.h"

namespace psf::film {
namespace {

// OpenEXR takes (and never writes through) a non-const base pointer.
Imf::Slice slice(const std::vector<float>& values, std::size_t width) {
  char* base = reinterpret_cast<char*>(const_cast<float*>(values.data()));
  return {Imf::FLOAT, base, sizeof(float), sizeof(float) * width};
}

}  // namespace

Image read_exr(const std::string& path) {
  try {
    check_exr(path);
    // Not the table of chunks: see picture.cpp.
    Imf::MultiPartInputFile file(path.c_str(), 0, false);
    check_part(path, file.header(0));
    Imf::InputPart input(file, 0);
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
      const std::string name = at.name();
      if (name == "type" || name == "name") continue;  // of the part, and not for us to write
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&at.attribute())) {
        image.attributes.emplace_back(name, text->value());
      }
    }
    return image;
  } catch (const Error& error) {
    throw Error(error.code(), one_line(error.what()));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Iex::EmfileExc& error) {
    throw Error(ErrorCode::io, path + ": cannot open: " + one_line(error.what()));
  } catch (const std::exception& error) {
    throw Error(ErrorCode::bad_input,
                path + ": no readable EXR picture: " + one_line(error.what()));
  }
}

}  // namespace psf::film
