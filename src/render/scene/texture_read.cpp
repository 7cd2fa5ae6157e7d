// Textures out of picture files, by OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

#include "core/error.h"
#include "render/scene/texture.h"
#include "render/scene/texture_file.h"

namespace psf::render {
namespace {

constexpr std::size_t kMaxTexels = std::size_t{1} << 28;
// A value beyond its range by no more was rounded by a converter and is no news.
constexpr float kRounding = 1e-3f;

struct Kind {
  std::string_view magic, name, extension;
  std::size_t at = 0;
};
constexpr Kind kKinds[] = {{"\x89PNG", "PNG", "png"},
                           {"\xFF\xD8\xFF", "JPEG", "jpg"},
                           {"RIFF", "WebP", "webp"},
                           {"DDS ", "DDS", "dds"},
                           {"GIF8", "GIF", "gif"},
                           {"BM", "BMP", "bmp"},
                           {"v/1\x01", "OpenEXR", "exr"},
                           {"#?", "Radiance", "hdr"},
                           {"\xABKTX 20\xBB", "KTX2", ""},
                           {"\xABKTX 11\xBB", "KTX", ""},
                           {"sB\x13", "Basis Universal", ""},
                           {"\xFF\x0A", "JPEG XL", ""},
                           {"ftypavi", "AVIF", "avif", 4}};

const Kind* kind_of(std::string_view start) {
  const auto found = std::find_if(std::begin(kKinds), std::end(kKinds), [&](const Kind& kind) {
    return start.size() >= kind.at + kind.magic.size() &&
           start.substr(kind.at, kind.magic.size()) == kind.magic;
  });
  return found == std::end(kKinds) ? nullptr : found;
}

std::string start_of(const std::string& path, std::span<const unsigned char> bytes) {
  std::string start(16, '\0');
  if (bytes.empty()) {
    std::ifstream file(path, std::ios::binary);
    file.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(file.gcount()));
  } else {
    start.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(
                                                    std::min<std::size_t>(16, bytes.size())));
  }
  return start;
}

// One line of what OpenImageIO said. Asking also clears it, or OIIO prints it at exit.
std::string first_line(std::string text) {
  const std::size_t end = text.find('\n');
  if (end != std::string::npos) text.resize(end);
  return text.empty() ? "it is no picture that OpenImageIO reads" : text;
}

// An open picture file, or bytes of one.
struct Picture {
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory;
  std::unique_ptr<OIIO::ImageInput> input;
  std::string problem;  // where there is no input

  Picture(const std::string& path, std::span<const unsigned char> bytes) {
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);  // colours as stored, not times alpha
    const Kind* kind = kind_of(start_of(path, bytes));
    std::string name = path;
    if (!bytes.empty()) {
      memory = std::make_unique<OIIO::Filesystem::IOMemReader>(
          const_cast<unsigned char*>(bytes.data()), bytes.size());
      // OIIO 2.4 forgets the proxy where there is a configuration, unless it is part of it.
      void* proxy = memory.get();
      config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
      // With a proxy the name only says the format, and its file need not exist.
      name = "embedded." + std::string(kind && !kind->extension.empty() ? kind->extension : "png");
    }
    if (kind != nullptr && kind->extension.empty()) {
      problem = fmt::format("psf reads no {} pictures", kind->name);
      return;
    }
    input = OIIO::ImageInput::open(name, &config, memory.get());
    const std::string said = first_line(OIIO::geterror());
    if (!input) problem = said;
  }
};

Error unreadable(const std::string& name, const std::string& why) {
  return {ErrorCode::bad_input, name + ": cannot read the picture: " + why};
}

void refuse_size(const std::string& name, const OIIO::ImageSpec& spec, const TexelMap& map) {
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  for (const auto& [width, height] :
       {std::pair(map.width(), map.height()),
        std::pair(static_cast<std::size_t>(spec.width), static_cast<std::size_t>(spec.height))}) {
    if (width > kMaxTexels / height || width * height > 4 * kMaxTexels / channels) {
      throw Error(ErrorCode::limit,
                  fmt::format("{}: {} x {} texels of {} channels are more than psf takes (2^28)",
                              name, width, height, channels));
    }
  }
}

// The stored values of every channel, (height, width, channels); closes the file.
template <class T>
std::vector<T> read_values(const std::string& name, OIIO::ImageInput& input,
                           const OIIO::ImageSpec& spec, std::vector<std::string>& notes) {
  std::vector<T> values(static_cast<std::size_t>(spec.width) *
                        static_cast<std::size_t>(spec.height) *
                        static_cast<std::size_t>(spec.nchannels));
  if (!input.read_image(0, 0, 0, spec.nchannels, OIIO::BaseTypeFromC<T>::value, values.data()))
    throw unreadable(name, first_line(input.geterror()));
  if (input.seek_subimage(1, 0)) notes.push_back(name + ": has several parts, the first is taken");
  (void)input.geterror();
  input.close();
  return values;
}

// Values of a kind in the range that their use allows; counts those that were not.
class ValueRange {
 public:
  ValueRange(const std::string& name, TextureUse use, std::size_t width)
      : name_(name), most_(use == TextureUse::radiance ? INFINITY : 1), width_(width) {}

  [[nodiscard]] Rgb clamp(const Rgb& c, std::size_t index) {
    bool out = false;
    Rgb result;
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(c[k])) {
        throw Error(ErrorCode::bad_input, fmt::format("{}: texel ({}, {}) is not finite", name_,
                                                      index % width_, index / width_));
      }
      out |= c[k] < -kRounding || c[k] > most_ + kRounding;
      result[k] = std::clamp(c[k], 0.0f, most_);
    }
    if (out && count_++ == 0) {
      first_ = fmt::format("({}, {}): {:.4g} {:.4g} {:.4g}", index % width_, index / width_, c.x,
                           c.y, c.z);
    }
    return result;
  }
  void tell(std::size_t texels, std::vector<std::string>& notes) const {
    if (count_ == 0) return;
    notes.push_back(fmt::format("{}: {} of {} texels are {} and are clamped; the first is {}",
                                name_, count_, texels,
                                std::isfinite(most_) ? "outside [0, 1]" : "below 0", first_));
  }

 private:
  const std::string& name_;
  float most_;
  std::size_t width_, count_ = 0;
  std::string first_;
};

// What of a texel is there, from all its channels.
class TexelOpacity {
 public:
  TexelOpacity(const OIIO::ImageSpec& spec, const ColourChannels& colour, TextureUse use)
      : colour_(colour) {
    if (spec.alpha_channel >= 0) alpha_ = static_cast<std::size_t>(spec.alpha_channel);
    whole_ = !alpha_ && use == TextureUse::alpha;
  }
  [[nodiscard]] Rgb operator()(const float* v) const {
    if (whole_) return Rgb(1);
    if (alpha_) return Rgb(v[*alpha_]);
    return Rgb(luminance(Rgb(v[colour_.red], v[colour_.green], v[colour_.blue])));
  }

 private:
  ColourChannels colour_;
  std::optional<std::size_t> alpha_;
  bool whole_;
};

}  // namespace

Texture Texture::load(const std::string& path, TextureUse use, std::vector<std::string>& notes,
                      bool plain) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw Error(ErrorCode::io, path + ": no such picture");
  Texture texture = read(path, {}, use, notes, plain);
  return use == TextureUse::relief && texture.grey() ? texture.normals_of_heights() : texture;
}

Texture Texture::decode(std::span<const unsigned char> bytes, const std::string& name,
                        TextureUse use, std::vector<std::string>& notes, bool plain) {
  if (bytes.empty()) throw Error(ErrorCode::bad_input, name + ": an empty picture");
  return read(name, bytes, use, notes, plain);
}

std::string Texture::why_unreadable(const std::string& path, std::span<const unsigned char> bytes) {
  return Picture(path, bytes).problem;
}

// From `bytes`, or from the file `name` where there are none.
Texture Texture::read(const std::string& name, std::span<const unsigned char> bytes, TextureUse use,
                      std::vector<std::string>& notes, bool plain) {
  const Picture picture(name, bytes);
  if (!picture.input) throw unreadable(name, picture.problem);
  OIIO::ImageInput& input = *picture.input;
  const OIIO::ImageSpec spec = input.spec();
  refuse_layout(name, spec);
  const TexelMap map(name, spec);
  const ColourChannels c = colour_channels(name, spec, use, notes);
  const auto curve = transfer_curve(name, spec, use, plain);
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  refuse_size(name, spec, map);

  Texture texture(map.width(), map.height());
  const std::size_t count = texture.width_ * texture.height_;
  const bool of_opacity = use == TextureUse::alpha || use == TextureUse::opacity;
  if (spec.format == OIIO::TypeDesc::UINT8 && !c.alpha && !of_opacity) {
    const auto values = read_values<std::uint8_t>(name, input, spec, notes);
    Table table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = curve(static_cast<float>(i) / 255.0f);
    texture.table_ = std::make_shared<const Table>(table);
    texture.packed_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto stored = map.stored(i % texture.width_, i / texture.width_);
      if (!stored) continue;
      const std::uint8_t* v = &values[*stored * channels];
      texture.packed_[i] =
          v[c.red] | (std::uint32_t{v[c.green]} << 8) | (std::uint32_t{v[c.blue]} << 16);
    }
    return texture;
  }
  const auto values = read_values<float>(name, input, spec, notes);
  const auto matrix = plain || use == TextureUse::numbers || use == TextureUse::relief
                          ? std::optional<Imath::M33f>()
                          : to_rec709(spec);
  const TexelOpacity opacity(spec, c, use);
  ValueRange range(name, use, texture.width_);
  texture.texels_.resize(count, Rgb(0));
  for (std::size_t i = 0; i < count; ++i) {
    const auto stored = map.stored(i % texture.width_, i / texture.width_);
    if (!stored) continue;
    const float* v = &values[*stored * channels];
    if (of_opacity) {
      texture.texels_[i] = range.clamp(opacity(v), i);
      continue;
    }
    const float alpha = c.alpha ? v[*c.alpha] : 1;
    const float divisor = alpha > 0 ? alpha : 1;  // under no alpha the colour is as stored
    Rgb colour(curve(v[c.red] / divisor), curve(v[c.green] / divisor), curve(v[c.blue] / divisor));
    if (matrix) {
      const Vec3 turned = Vec3(colour.x, colour.y, colour.z) * *matrix;
      colour = Rgb(turned.x, turned.y, turned.z);
    }
    texture.texels_[i] = range.clamp(colour, i);
  }
  range.tell(count, notes);
  return texture;
}

}  // namespace psf::render

namespace {

png_error_ptr said = nullptr;  // the error handler that was set last

[[noreturn]] void end_reading(png_structp png, png_const_charp text) {
  said(png, text);
  png_longjmp(png, 1);
}

}  // namespace

// In place of libpng's: OpenImageIO's function for errors returns, and then libpng prints them.
extern "C" [[gnu::visibility("default")]] void png_set_error_fn(png_structrp png, png_voidp pointer,
                                                                png_error_ptr error,
                                                                png_error_ptr warning) {
  static auto* const set = reinterpret_cast<decltype(&png_set_error_fn)>(
      ::dlsym(RTLD_NEXT, "png_set_error_fn"));  // NOLINT: so POSIX has it
  if (error != nullptr) said = error;
  set(png, pointer, error != nullptr ? end_reading : nullptr, warning);
}
