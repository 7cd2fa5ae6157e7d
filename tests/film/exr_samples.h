// EXRs as other programs write them, made by OpenEXR itself.
#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>

#include <string>
#include <vector>

namespace psf::tests {

// The value of channel `k` at a place of the plane: another at every place, exact in half floats.
inline float sample_value(int x, int y, int k) {
  return 0.25f * static_cast<float>((x * 7 + y * 13 + k * 3) % 64) + 0.25f;
}

struct SampleChannel {
  std::string name;
  Imf::PixelType type = Imf::FLOAT;
};

inline Imath::Box2i box(int left, int top, int width, int height) {
  return {{left, top}, {left + width - 1, top + height - 1}};
}

// Values of every channel over a data window, and a frame buffer for them.
struct SamplePixels {
  SamplePixels(const Imath::Box2i& window, const std::vector<SampleChannel>& channels) {
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    planes.resize(channels.size());
    for (std::size_t k = 0; k < channels.size(); ++k) {
      planes[k].resize(static_cast<std::size_t>(width * height));
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const float value = sample_value(window.min.x + x, window.min.y + y, static_cast<int>(k));
          Plane& plane = planes[k][static_cast<std::size_t>(y * width + x)];
          if (channels[k].type == Imf::UINT) {
            plane.whole = static_cast<unsigned>(4 * value);
          } else if (channels[k].type == Imf::HALF) {
            plane.half = Imath::half(value).bits();
          } else {
            plane.number = value;
          }
        }
      }
      buffer.insert(channels[k].name,
                    Imf::Slice::Make(channels[k].type, planes[k].data(), window, sizeof(Plane),
                                     sizeof(Plane) * static_cast<std::size_t>(width)));
    }
  }
  union Plane {
    float number;
    unsigned whole;
    unsigned short half;
  };
  std::vector<std::vector<Plane>> planes;
  Imf::FrameBuffer buffer;
};

inline Imf::Header sample_header(const Imath::Box2i& display, const Imath::Box2i& data,
                                 const std::vector<SampleChannel>& channels,
                                 Imf::Compression compression = Imf::ZIP_COMPRESSION) {
  Imf::Header header(display, data);
  header.compression() = compression;
  for (const SampleChannel& channel : channels) {
    header.channels().insert(channel.name, Imf::Channel(channel.type));
  }
  return header;
}

inline void write_lines(const std::string& path, const Imf::Header& header,
                        const std::vector<SampleChannel>& channels, int lines = -1) {
  const Imath::Box2i window = header.dataWindow();
  SamplePixels pixels(window, channels);
  Imf::OutputFile file(path.c_str(), header, 0);
  file.setFrameBuffer(pixels.buffer);
  file.writePixels(lines < 0 ? window.max.y - window.min.y + 1 : lines);
}

inline const std::vector<SampleChannel> kRgb = {{"R"}, {"G"}, {"B"}};

}  // namespace psf::tests
