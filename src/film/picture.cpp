#include "film/picture.h"

#include <IexErrnoExc.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/error.h"
#include "core/lower.h"
#include "film/exr_check.h"
#include "film/exr_layers.h"
#include "film/light_layers.h"

namespace psf::film {
namespace {

// What lies in the data window.
struct Pixels {
  Imath::Box2i window;
  std::vector<Rgb> colors;
  std::vector<float> alpha;  // empty: there is none

  [[nodiscard]] std::size_t width() const {
    return static_cast<std::size_t>(window.max.x - window.min.x + 1);
  }
  [[nodiscard]] std::size_t height() const {
    return static_cast<std::size_t>(window.max.y - window.min.y + 1);
  }
};

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw Error(ErrorCode::bad_input, path + ": " + what);
}

int number_of(const Imf::Header& header, const char* name, int otherwise) {
  const auto* attribute = header.findTypedAttribute<Imf::IntAttribute>(name);
  return attribute == nullptr ? otherwise : attribute->value();
}

// What changes the meaning of pixels and is not honoured.
void check_meaning(const std::string& path, const Imf::Header& header) {
  const int orientation = number_of(header, "Orientation", 1);
  if (orientation != 1) {
    refuse(path, fmt::format("is turned or mirrored, its attribute Orientation is {}; turn it "
                             "upright, for example with oiiotool --reorient",
                             orientation));
  }
  if (const auto* space = header.findTypedAttribute<Imf::StringAttribute>("oiio:ColorSpace")) {
    const std::string name = core::lower(space->value());
    const bool linear = name.find("lin") != std::string::npos;  // "sRGB - Linear", "lin_srgb"
    if (!linear && (name.starts_with("srgb") || name.starts_with("gamma") || name == "rec709")) {
      refuse(path,
             fmt::format("its colours are not linear, its attribute oiio:ColorSpace is "
                         "\"{}\"; convert it, for example with oiiotool --tocolorspace linear",
                         space->value()));
    }
  }
}

void check_sampling(const std::string& path, const Imf::Header& header, const std::string& name) {
  const Imf::Channel& channel = header.channels()[name];
  if (channel.xSampling == 1 && channel.ySampling == 1) return;
  refuse(path, fmt::format("its channel {} has only each {} x {}th pixel, which is read of "
                           "luminance-chroma alone; resample it",
                           name, channel.xSampling, channel.ySampling));
}

Pixels read_plain(const std::string& path, Imf::InputPart& input, const ExrLayer& layer) {
  Pixels pixels;
  pixels.window = input.header().dataWindow();
  pixels.colors.resize(pixels.width() * pixels.height());
  Imf::FrameBuffer buffer;
  const std::size_t count = layer.kind == LayerKind::grey ? 1 : 3;
  for (std::size_t k = 0; k < count; ++k) {
    check_sampling(path, input.header(), layer.channels[k]);
    buffer.insert(layer.channels[k],
                  Imf::Slice::Make(Imf::FLOAT, &pixels.colors[0][static_cast<int>(k)],
                                   pixels.window, sizeof(Rgb), sizeof(Rgb) * pixels.width()));
  }
  if (!layer.alpha.empty()) {
    check_sampling(path, input.header(), layer.alpha);
    pixels.alpha.resize(pixels.colors.size());
    buffer.insert(layer.alpha, Imf::Slice::Make(Imf::FLOAT, pixels.alpha.data(), pixels.window));
  }
  input.setFrameBuffer(buffer);
  input.readPixels(pixels.window.min.y, pixels.window.max.y);
  if (count == 1) {
    for (Rgb& color : pixels.colors) color = Rgb(color.x);
  }
  return pixels;
}

// OpenEXR reconstructs the chroma of the pixels between and its colours, in half floats.
Pixels read_chroma(const std::string& path, const ExrLayer& layer) {
  Imf::RgbaInputFile input(path.c_str(), layer.prefix, 0);
  Pixels pixels;
  pixels.window = input.dataWindow();
  const std::size_t width = pixels.width();
  std::vector<Imf::Rgba> row(width);
  pixels.colors.reserve(width * pixels.height());
  // Every row goes to the same place.
  input.setFrameBuffer(row.data() - pixels.window.min.x, 1, 0);
  for (int y = pixels.window.min.y; y <= pixels.window.max.y; ++y) {
    input.readPixels(y);
    for (const Imf::Rgba& color : row) {
      pixels.colors.emplace_back(color.r, color.g, color.b);
      if (!layer.alpha.empty()) pixels.alpha.push_back(color.a);
    }
  }
  return pixels;
}

// The layer of the background of this one, where a picture of ours keeps it apart; else null.
const ExrLayer* background_of(const Imf::Header& header, const ExrLayer& layer,
                              const std::vector<ExrLayer>& layers) {
  const auto* is = header.findTypedAttribute<Imf::StringAttribute>(kBackgroundIs);
  if (is == nullptr || is->value() != kApart || layer.kind != LayerKind::color) return nullptr;
  const std::string prefix = (layer.prefix.empty() ? "" : layer.prefix + ".") + kBackground;
  const auto found = std::find_if(layers.begin(), layers.end(), [&](const ExrLayer& other) {
    return other.part == layer.part && other.prefix == prefix && other.kind == LayerKind::color;
  });
  return found == layers.end() ? nullptr : &*found;
}

void apply_alpha(const Imf::Header& header, Pixels& pixels, Picture& picture) {
  if (pixels.alpha.empty()) return;
  const bool unassociated = number_of(header, "oiio:UnassociatedAlpha", 0) != 0;
  if (unassociated) {
    for (std::size_t i = 0; i < pixels.alpha.size(); ++i) pixels.colors[i] *= pixels.alpha[i];
  }
  const auto part = std::count_if(pixels.alpha.begin(), pixels.alpha.end(),
                                  [](float alpha) { return alpha != 1; });
  if (part == 0) return;
  picture.notes.push_back(
      fmt::format("{}: {} of {} pixels are not opaque; their colours are taken {}, over black",
                  picture.path, part, pixels.alpha.size(),
                  unassociated ? "times alpha, as the file has them without it" : "as they are"));
}

// Sets the display window, and what of the pixels lies in it.
void place(const Imath::Box2i& display, Pixels pixels, Picture& picture) {
  picture.left = display.min.x;
  picture.top = display.min.y;
  picture.width = static_cast<std::size_t>(display.max.x - display.min.x + 1);
  picture.height = static_cast<std::size_t>(display.max.y - display.min.y + 1);
  if (pixels.window == display) {
    picture.colors = std::move(pixels.colors);
    return;
  }
  picture.colors.assign(picture.width * picture.height, Rgb(0));
  const int left = std::max(display.min.x, pixels.window.min.x);
  const int right = std::min(display.max.x, pixels.window.max.x);
  const int top = std::max(display.min.y, pixels.window.min.y);
  const int bottom = std::min(display.max.y, pixels.window.max.y);
  for (int y = top; y <= bottom && left <= right; ++y) {
    const Rgb* from = pixels.colors.data() +
                      static_cast<std::size_t>(y - pixels.window.min.y) * pixels.width() +
                      (left - pixels.window.min.x);
    std::copy(from, from + (right - left + 1),
              picture.colors.data() + static_cast<std::size_t>(y - display.min.y) * picture.width +
                  (left - display.min.x));
  }
  picture.notes.push_back(fmt::format(
      "{}: has the pixels {},{},{}x{} of a picture {},{},{}x{}; what it has not is black, what is "
      "outside is left out",
      picture.path, pixels.window.min.x, pixels.window.min.y, pixels.width(), pixels.height(),
      picture.left, picture.top, picture.width, picture.height));
}

void describe(const Imf::Header& header, const ExrLayer& layer, Picture& picture) {
  const Imf::Chromaticities c =
      Imf::hasChromaticities(header) ? Imf::chromaticities(header) : Imf::Chromaticities();
  picture.primaries = {c.red.x,  c.red.y,  c.green.x, c.green.y,
                       c.blue.x, c.blue.y, c.white.x, c.white.y};
  if (Imf::hasEnvmap(header)) {
    picture.environment = Imf::envmap(header) == Imf::ENVMAP_CUBE ? "cube" : "latlong";
  }
  picture.layer = layer.name;
}

Picture read(const std::string& path, const PictureRequest& request) {
  // Not the table of chunks: to make that anew means to read a damaged file from end to end.
  Imf::MultiPartInputFile file(path.c_str(), 0, false);
  std::vector<ExrPart> parts;
  for (int k = 0; k < file.parts(); ++k) {
    const Imf::Header& header = file.header(k);
    parts.push_back({header.hasName() ? header.name() : "", {}});
    for (auto at = header.channels().begin(); at != header.channels().end(); ++at) {
      parts.back().channels.emplace_back(at.name());
    }
  }
  const std::vector<ExrLayer> layers = exr_layers(parts);
  const ExrLayer layer =
      choose_layer(path, layers, request.layer, request.fallback, request.parameter);
  const auto part = static_cast<int>(layer.part);
  const Imf::Header& header = file.header(part);
  check_part(path, header);
  check_meaning(path, header);
  if (!file.partComplete(part)) {
    refuse(path, "is incomplete, some of its pixels were never written");
  }
  Picture picture;
  picture.path = path;
  describe(header, layer, picture);
  if (layer.kind == LayerKind::chroma && parts.size() > 1) {
    refuse(path, "holds luminance and chroma in one of several parts; convert it to R, G, B");
  }
  Imf::InputPart input(file, part);
  Pixels pixels =
      layer.kind == LayerKind::chroma ? read_chroma(path, layer) : read_plain(path, input, layer);
  if (const ExrLayer* background = background_of(header, layer, layers)) {
    const Pixels behind = read_plain(path, input, *background);
    for (std::size_t i = 0; i < behind.colors.size(); ++i) pixels.colors[i] += behind.colors[i];
    pixels.alpha.clear();  // nothing is transparent before its background
  }
  apply_alpha(header, pixels, picture);
  place(header.displayWindow(), std::move(pixels), picture);
  if (request.layer.empty() && !layer.name.empty()) {
    picture.notes.push_back(
        fmt::format("{}: has no colours at its root, its layer {} is taken", path, layer.name));
  }
  return picture;
}

}  // namespace

Picture read_picture(const std::string& path, const PictureRequest& request) {
  try {
    check_exr(path);
    return read(path, request);
  } catch (const Error& error) {
    throw Error(error.code(), one_line(error.what()));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Iex::EmfileExc& error) {
    throw Error(ErrorCode::io, path + ": cannot open: " + one_line(error.what()));
  } catch (const std::exception& error) {
    refuse(path, "no readable EXR picture: " + one_line(error.what()));
  }
}

std::string check_comparable(const Picture& picture, const Picture& reference) {
  if (picture.width != reference.width || picture.height != reference.height) {
    refuse(picture.path,
           fmt::format("is {}x{}, but {} is {}x{}; compare pictures of one size", picture.width,
                       picture.height, reference.path, reference.width, reference.height));
  }
  if (picture.left != reference.left || picture.top != reference.top) {
    refuse(picture.path,
           fmt::format("its display window begins at {},{}, that of {} at {},{}; compare pictures "
                       "of one place",
                       picture.left, picture.top, reference.path, reference.left, reference.top));
  }
  if (picture.environment != reference.environment) {
    const auto kind = [](const Picture& one) {
      return one.environment.empty() ? "a picture"
                                     : "a map of directions (" + one.environment + ")";
    };
    refuse(picture.path, fmt::format("is {}, but {} is {}; compare pictures of one kind",
                                     kind(picture), reference.path, kind(reference)));
  }
  constexpr float kRounding = 1e-3f;  // primaries are written with three digits or four
  for (std::size_t k = 0; k < picture.primaries.size(); ++k) {
    if (std::abs(picture.primaries[k] - reference.primaries[k]) <= kRounding) continue;
    return fmt::format(
        "{} and {} have other primaries or another white (chromaticities); their "
        "values are compared as they are",
        picture.path, reference.path);
  }
  return "";
}

}  // namespace psf::film
