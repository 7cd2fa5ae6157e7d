#include "render/texture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <memory>

#include "formats/error.h"

namespace psf::render {
namespace {

constexpr std::size_t kMaxTexels = std::size_t{1} << 28;

// One line of what OpenImageIO said. Asking also clears it, or OIIO prints it at exit.
std::string first_line(std::string text) {
  const std::size_t end = text.find('\n');
  if (end != std::string::npos) text.resize(end);
  return text.empty() ? "it is no picture that OpenImageIO reads" : text;
}

// A file name of the format that these bytes are, of those that glTF embeds.
std::string format_hint(std::span<const unsigned char> bytes) {
  const auto starts_with = [&](std::initializer_list<unsigned char> magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (starts_with({0xFF, 0xD8, 0xFF})) return "embedded.jpg";
  if (starts_with({'R', 'I', 'F', 'F'})) return "embedded.webp";
  return "embedded.png";
}

struct Wrapped {
  std::size_t first, second;
  float weight;  // of second
};

// The two texels around `coordinate`, whose picture repeats after 1 and has `size` texels.
Wrapped wrap(float coordinate, std::size_t size) {
  float part = coordinate - std::floor(coordinate);
  if (!(part >= 0 && part <= 1)) part = 0;  // not finite
  const float position = part * static_cast<float>(size) - 0.5f;
  if (position < 0) return {size - 1, 0, position + 1};
  const std::size_t first = std::min(static_cast<std::size_t>(position), size - 1);
  const std::size_t second = first + 1 < size ? first + 1 : 0;
  return {first, second, position - static_cast<float>(first)};
}

}  // namespace

Texture::Texture(std::size_t width, std::size_t height, std::vector<Rgb> texels)
    : width_(width), height_(height), texels_(std::move(texels)) {
  if (width == 0 || height == 0 || texels_.size() != width * height) {
    throw Error(ErrorCode::bad_input,
                fmt::format("a texture of {} x {} texels needs {}, got {}", width, height,
                            std::max<std::size_t>(1, width * height), texels_.size()));
  }
}

const Texture::Table& Texture::table_of(ColorSpace color_space) {
  const auto make = [](auto curve) {
    Table table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = curve(static_cast<float>(i) / 255.0f);
    return table;
  };
  static const Table srgb = make(srgb_to_linear);
  static const Table linear = make([](float value) { return value; });
  return color_space == ColorSpace::srgb ? srgb : linear;
}

Texture Texture::load(const std::string& path, ColorSpace color_space) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw Error(ErrorCode::io, path + ": no such picture");
  return read(path, {}, color_space);
}

Texture Texture::decode(std::span<const unsigned char> bytes, const std::string& name,
                        ColorSpace color_space) {
  if (bytes.empty()) throw Error(ErrorCode::bad_input, name + ": an empty picture");
  return read(name, bytes, color_space);
}

// From `bytes`, or from the file `name` where there are none.
Texture Texture::read(const std::string& name, std::span<const unsigned char> bytes,
                      ColorSpace color_space) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // colours as stored, not times alpha
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;
  if (!bytes.empty()) {
    memory = std::make_unique<OIIO::Filesystem::IOMemReader>(
        const_cast<unsigned char*>(bytes.data()), bytes.size());
    // OIIO 2.4 forgets the proxy where there is a configuration, unless it is part of it.
    void* proxy = memory.get();
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  }
  const auto fail = [&](const std::string& why) -> Error {
    return {ErrorCode::bad_input, name + ": cannot read the picture: " + first_line(why)};
  };
  // With a proxy the name only says the format, and its file need not exist.
  auto input = OIIO::ImageInput::open(memory ? format_hint(bytes) : name, &config, memory.get());
  if (!input) throw fail(OIIO::geterror());

  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 || spec.nchannels <= 0) {
    throw Error(ErrorCode::bad_input, name + ": cannot read the picture: it has no texels");
  }
  const auto width = static_cast<std::size_t>(spec.width),
             height = static_cast<std::size_t>(spec.height);
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  const bool bytes_8 = spec.format == OIIO::TypeDesc::UINT8;
  const bool integer = !spec.format.is_floating_point();
  if (width > kMaxTexels / height || width * height > 4 * kMaxTexels / channels) {
    throw Error(ErrorCode::limit,
                fmt::format("{}: {} x {} texels of {} channels are more than psf takes (2^28)",
                            name, width, height, channels));
  }

  Texture texture(width, height);
  const std::size_t green = channels >= 3 ? 1 : 0, blue = channels >= 3 ? 2 : 0;
  const auto read_into = [&](OIIO::TypeDesc type, auto& values) {
    values.resize(width * height * channels);
    if (!input->read_image(0, 0, 0, spec.nchannels, type, values.data()))
      throw fail(input->geterror());
    input->close();
  };
  if (bytes_8) {
    std::vector<std::uint8_t> values;
    read_into(OIIO::TypeDesc::UINT8, values);
    texture.table_ = &table_of(color_space);
    texture.packed_.resize(width * height);
    for (std::size_t i = 0; i < texture.packed_.size(); ++i) {
      const std::uint8_t* v = &values[i * channels];
      texture.packed_[i] = v[0] | (std::uint32_t{v[green]} << 8) | (std::uint32_t{v[blue]} << 16);
    }
    return texture;
  }
  std::vector<float> values;
  read_into(OIIO::TypeDesc::FLOAT, values);
  const bool decode_srgb = integer && color_space == ColorSpace::srgb;
  const auto linear = [&](float value) { return decode_srgb ? srgb_to_linear(value) : value; };
  texture.texels_.resize(width * height);
  for (std::size_t i = 0; i < texture.texels_.size(); ++i) {
    const float* v = &values[i * channels];
    if (!std::isfinite(v[0]) || !std::isfinite(v[green]) || !std::isfinite(v[blue])) {
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: texel ({}, {}) is not finite", name, i % width, i / width));
    }
    texture.texels_[i] = Rgb(linear(v[0]), linear(v[green]), linear(v[blue]));
  }
  return texture;
}

Rgb Texture::at(const Vec2& uv) const {
  const Wrapped x = wrap(uv.x, width_);
  const Wrapped y = wrap(1 - uv.y, height_);
  const Rgb top = texel(x.first, y.first) * (1 - x.weight) + texel(x.second, y.first) * x.weight;
  const Rgb bottom =
      texel(x.first, y.second) * (1 - x.weight) + texel(x.second, y.second) * x.weight;
  return top * (1 - y.weight) + bottom * y.weight;
}

}  // namespace psf::render
