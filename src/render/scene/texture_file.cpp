#include "render/scene/texture_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/lower.h"

namespace psf::render {
namespace {

using Imath::M33d;
using Imath::V3d;

bool same_word(std::string_view a, std::string_view b) {
  return core::lower(a) == core::lower(b);
}

std::optional<std::size_t> find_channel(const OIIO::ImageSpec& spec, const std::string& name) {
  for (std::size_t k = 0; k < spec.channelnames.size(); ++k) {
    if (same_word(spec.channelnames[k], name)) return k;
  }
  return std::nullopt;
}

bool is_openexr(const OIIO::ImageSpec& spec) {
  // The only one of OpenImageIO's formats with a display window of its own.
  return spec.find_attribute("screenWindowWidth") != nullptr;
}

// Chromaticities in the order of OpenEXR: red, green, blue, white, x and y of each.
using Chromaticities = std::array<float, 8>;
constexpr Chromaticities kRec709 = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};

V3d white_of(const Chromaticities& c) {
  const double x = c[6], y = c[7];
  return {x / y, 1, (1 - x - y) / y};
}

// RGB to CIE XYZ with Y = 1 for white, for row vectors.
M33d to_xyz(const Chromaticities& c) {
  M33d primaries;
  for (int k = 0; k < 3; ++k) {
    const double x = c[static_cast<std::size_t>(2 * k)], y = c[static_cast<std::size_t>(2 * k + 1)];
    primaries[k][0] = x / y;
    primaries[k][1] = 1;
    primaries[k][2] = (1 - x - y) / y;
  }
  const V3d scale = white_of(c) * primaries.inverse();
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 3; ++i) primaries[k][i] *= scale[k];
  }
  return primaries;
}

// Bradford's adaptation of one white to another, in XYZ.
M33d adaptation(const V3d& from, const V3d& to) {
  const M33d cone(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);
  const V3d a = from * cone, b = to * cone;
  const M33d scale(b.x / a.x, 0, 0, 0, b.y / a.y, 0, 0, 0, b.z / a.z);
  return cone * scale * cone.inverse();
}

}  // namespace

void refuse_layout(const std::string& name, const OIIO::ImageSpec& spec) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::bad_input, name + ": " + what);
  };
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0)
    fail("cannot read the picture: it has no texels");
  if (spec.depth > 1) fail("is a volume; psf reads pictures of one layer of texels");
  const std::string format = spec.get_string_attribute("textureformat");
  if (format.find("CubeFace") != std::string::npos) {
    fail("is a cube map (OpenEXR's envmap says so); make it a latitude-longitude picture");
  }
  // OpenImageIO 2.5 names the channels R, G, B, and reads them only where they are subsampled.
  if ((find_channel(spec, "RY") && find_channel(spec, "BY")) ||
      spec.get_int_attribute("openexr:luminancechroma") != 0) {
    fail("has luminance and chroma (Y, RY, BY) for colours; make it RGB");
  }
}

ColourChannels colour_channels(const std::string& name, const OIIO::ImageSpec& spec, TextureUse use,
                               std::vector<std::string>& notes) {
  ColourChannels c;
  const auto named = [&](const std::string& layer) {
    const auto r = find_channel(spec, layer + "R"), g = find_channel(spec, layer + "G"),
               b = find_channel(spec, layer + "B");
    if (r && g && b) c.red = *r, c.green = *g, c.blue = *b;
    return r && g && b;
  };
  std::string layer;
  bool found = named("");
  for (std::size_t k = 0; !found && k < spec.channelnames.size(); ++k) {
    const std::size_t dot = spec.channelnames[k].rfind('.');
    if (dot == std::string::npos) continue;
    layer = spec.channelnames[k].substr(0, dot + 1);
    found = named(layer);
    if (found) notes.push_back(fmt::format("{}: has layers, {} is taken", name, layer + "RGB"));
  }
  if (!found) {
    layer.clear();
    if (spec.nchannels >= 3) {
      c.green = 1, c.blue = 2;
    } else {
      c.red = c.green = c.blue = find_channel(spec, "Y").value_or(0);
    }
  }
  // Formats whose colours are times alpha in the file. Light is what is stored.
  const bool premultiplied =
      is_openexr(spec) || (spec.find_attribute("tiff:PhotometricInterpretation") != nullptr &&
                           spec.get_int_attribute("tiff:UnassociatedAlpha") == 0 &&
                           spec.get_int_attribute("oiio:UnassociatedAlpha") == 0);
  if (premultiplied && use != TextureUse::radiance) {
    c.alpha = find_channel(spec, layer + "A");
    if (!c.alpha && layer.empty() && spec.alpha_channel >= 0)
      c.alpha = static_cast<std::size_t>(spec.alpha_channel);
  }
  return c;
}

std::function<float(float)> transfer_curve(const std::string& name, const OIIO::ImageSpec& spec,
                                           TextureUse use, bool plain) {
  const auto linear = [](float value) { return value; };
  if (use == TextureUse::numbers || use == TextureUse::relief) return linear;
  const bool integer = !spec.format.is_floating_point();
  if (plain) return integer ? std::function<float(float)>(srgb_to_linear) : linear;
  const std::string space = spec.get_string_attribute("oiio:ColorSpace");
  if (same_word(space, "KodakLog")) {
    throw Error(ErrorCode::bad_input, name + ": has a logarithmic scale (" + space +
                                          "); make it linear, or sRGB in 8 or 16 bits");
  }
  const float gamma = spec.get_float_attribute("oiio:Gamma", 0);
  // A gamma of about 2.2 stands for sRGB in all files that have both.
  const bool has_gamma = std::isfinite(gamma) && gamma > 0 && std::abs(gamma - 2.2f) > 0.05f;
  if (same_word(space, "Linear") || gamma == 1) return linear;
  if (has_gamma) return [gamma](float value) { return std::pow(std::max(value, 0.0f), gamma); };
  if (integer) return srgb_to_linear;
  return linear;
}

std::optional<Imath::M33f> to_rec709(const OIIO::ImageSpec& spec) {
  const OIIO::ParamValue* found =
      spec.find_attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8));
  if (found == nullptr) return std::nullopt;
  Chromaticities own{};
  std::copy_n(static_cast<const float*>(found->data()), own.size(), own.begin());
  bool differs = false;
  for (std::size_t k = 0; k < own.size(); ++k) {
    // A y of 0 says nothing; one below is that of a primary that is no light (ACES).
    if (!std::isfinite(own[k]) || (k % 2 == 1 && own[k] == 0)) return std::nullopt;
    differs |= std::abs(own[k] - kRec709[k]) > 1e-3f;
  }
  if (!differs) return std::nullopt;
  const M33d m =
      to_xyz(own) * adaptation(white_of(own), white_of(kRec709)) * to_xyz(kRec709).inverse();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      if (!std::isfinite(m[r][c]) || std::abs(m[r][c]) > 100) return std::nullopt;
    }
  }
  return Imath::M33f(m);
}

TexelMap::TexelMap(const std::string& name, const OIIO::ImageSpec& spec)
    : full_width_(static_cast<std::size_t>(spec.width)),
      full_height_(static_cast<std::size_t>(spec.height)),
      data_width_(full_width_),
      data_height_(full_height_),
      orientation_(spec.get_int_attribute("Orientation", 1)) {
  if (orientation_ < 1 || orientation_ > 8) orientation_ = 1;
  turned_ = orientation_ >= 5;
  // In other formats an offset is the place on a page.
  if (!is_openexr(spec) || spec.full_width <= 0 || spec.full_height <= 0) return;
  full_width_ = static_cast<std::size_t>(spec.full_width);
  full_height_ = static_cast<std::size_t>(spec.full_height);
  data_x_ = std::ptrdiff_t{spec.x} - spec.full_x;
  data_y_ = std::ptrdiff_t{spec.y} - spec.full_y;
  const bool outside = data_x_ >= spec.full_width || data_y_ >= spec.full_height ||
                       data_x_ + spec.width <= 0 || data_y_ + spec.height <= 0;
  if (outside)
    throw Error(ErrorCode::bad_input, name + ": all its data lie outside its display window");
}

std::optional<std::size_t> TexelMap::stored(std::size_t x, std::size_t y) const {
  const std::size_t right = full_width_ - 1, bottom = full_height_ - 1;
  std::size_t column = turned_ ? y : x, row = turned_ ? x : y;
  switch (orientation_) {
    case 2:
      column = right - column;
      break;
    case 3:
      column = right - column, row = bottom - row;
      break;
    case 4:
    case 6:
      row = bottom - row;
      break;
    case 7:
      column = right - column, row = bottom - row;
      break;
    case 8:
      column = right - column;
      break;
    default:
      break;
  }
  const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(column) - data_x_,
                       j = static_cast<std::ptrdiff_t>(row) - data_y_;
  if (i < 0 || j < 0 || i >= static_cast<std::ptrdiff_t>(data_width_) ||
      j >= static_cast<std::ptrdiff_t>(data_height_)) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(j) * data_width_ + static_cast<std::size_t>(i);
}

}  // namespace psf::render
