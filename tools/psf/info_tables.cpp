#include "info_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace psf::tools {
namespace {

void print_cameras(const formats::Metadata& metadata) {
  if (metadata.cameras.empty()) return;
  fmt::print("\n  {:<14}{:>13}  {}\n", "camera", "pixels", "angle per pixel");
  for (const formats::CameraInfo& camera : metadata.cameras) {
    const double degrees = camera.angle_per_pixel * 180 / std::numbers::pi;
    fmt::print("  {:<14}{:>13}  {}\n", shown_or_dash(camera.name),
               fmt::format("{} x {}", camera.width, camera.height),
               degrees == 0 ? "none" : fmt::format("{:.4f} degrees", degrees));
  }
}

void print_lights(const formats::Metadata& metadata) {
  constexpr std::size_t kShown = 32;
  if (metadata.lights.empty()) return;
  fmt::print("\n  {:<14}{}\n", "light", "visibility bit");
  for (std::size_t k = 0; k < std::min(kShown, metadata.lights.size()); ++k) {
    fmt::print("  {:<14}{}\n", shown_or_dash(metadata.lights[k]), k % 32);
  }
  if (metadata.lights.size() > kShown) {
    fmt::print("  and {} more, light l with bit l mod 32; --json has them\n",
               metadata.lights.size() - kShown);
  }
  if (!metadata.visibility_rule.empty()) {
    fmt::print("  bits are {}\n", shown_or_dash(metadata.visibility_rule));
  }
}

void print_materials(const formats::Metadata& metadata) {
  constexpr std::size_t kShown = 32;
  if (metadata.materials.empty()) return;
  fmt::print("\n  {:<14}{}\n", "material", "number");
  for (std::size_t k = 0; k < std::min(kShown, metadata.materials.size()); ++k) {
    fmt::print("  {:<14}{}\n", shown_or_dash(metadata.materials[k]), k);
  }
  if (metadata.materials.size() > kShown) {
    fmt::print("  and {} more; --json has them\n", metadata.materials.size() - kShown);
  }
}

}  // namespace

std::string shown_or_dash(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7F'; }, '?');
  return text.empty() ? "-" : text;
}

void print_tables(const formats::Metadata& metadata) {
  print_cameras(metadata);
  print_lights(metadata);
  print_materials(metadata);
}

}  // namespace psf::tools
