#include "render/scene/keys.h"

#include <algorithm>

namespace psf::render {

Between between(std::span<const double> times, double time) {
  if (!(time > times.front())) return {};
  if (time >= times.back()) return {times.size() - 1, 0};
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  const auto key = static_cast<std::size_t>(next - times.begin()) - 1;
  return {key, (time - times[key]) / (*next - times[key])};
}

double eased(Easing easing, double share) {
  switch (easing) {
    case Easing::step:
      return 0;
    case Easing::smooth:
      return share * share * (3 - 2 * share);
    case Easing::linear:
      break;
  }
  return share;
}

Imath::M44d Pose::matrix() const {
  return Imath::M44d().setScale(scale) * rotation.toMatrix44() *
         Imath::M44d().setTranslation(translation);
}

Pose mix(const Pose& a, const Pose& b, double share) {
  if (share == 0) return a;
  return {a.scale + (b.scale - a.scale) * share,
          Imath::slerpShortestArc(a.rotation, b.rotation, share).normalized(),
          a.translation + (b.translation - a.translation) * share};
}

}  // namespace psf::render
