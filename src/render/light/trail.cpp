#include "render/light/trail.h"

namespace psf::render {

void Trail::clear() {
  vertices_.clear();
  beyond_ = false;
  weight_ = Rgb(1, 1, 1);
  choice_ = before_ = Rgb(1, 1, 1);
}

void Trail::arrive(const Surface& surface, const Vec3& direction, float distance) {
  choice_ = vertices_.empty() ? before_ : Rgb(1, 1, 1);
  if (vertices_.size() == most_) {
    beyond_ = true;
    return;
  }
  PathVertex vertex;
  vertex.position = surface.position;
  vertex.distance = distance;
  vertex.normal = surface.normal;
  vertex.direction = -direction;
  vertex.material = static_cast<std::uint32_t>(surface.material);
  vertices_.push_back(vertex);
}

void Trail::meet(const Rgb& radiance, bool escaped) {
  if (vertices_.empty()) return;  // what the camera sees of the sky
  if (beyond_) {
    last().background += weight_ * radiance;
  } else if (escaped) {
    last().background = radiance;
  } else {
    last().emission = radiance;
  }
}

void Trail::scatters(const Rgb& reflectance, float roughness) {
  if (beyond_) return;
  last().reflectance = reflectance;
  last().roughness = roughness;
}

void Trail::select() {
  if (!beyond_) last().selected = true;
}

void Trail::add_direct(const Rgb& radiance) {
  if (beyond_) {
    last().background += weight_ * radiance * choice_;
  } else {
    last().direct += radiance * choice_;
  }
}

void Trail::scale(float factor) {
  choice_ *= factor;
}

void Trail::leave(const Vec3& direction, float pdf, const Rgb& throughput, std::uint8_t lobe) {
  if (beyond_) {
    weight_ = weight_ * throughput * choice_;
    return;
  }
  last().outgoing = direction;
  last().pdf = pdf;
  last().throughput = throughput * choice_;
  last().lobe = lobe;
}

void Trail::survive(float factor) {
  attenuate(Rgb(factor));
}

void Trail::attenuate(const Rgb& factor) {
  Rgb& carried = beyond_ ? weight_ : vertices_.empty() ? before_ : last().throughput;
  carried = carried * factor;
}

void Trail::end() {
  if (beyond_ || vertices_.empty()) return;
  last().outgoing = Vec3(0, 0, 0);
  last().pdf = 0;
  last().throughput = Rgb(0, 0, 0);
  last().lobe = 0;
}

}  // namespace psf::render
