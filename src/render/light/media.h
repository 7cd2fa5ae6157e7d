// In which medium a ray is, and in which it will be where it comes out.
#pragma once

#include <array>
#include <cstdint>

#include "render/scene/scene.h"

namespace psf::render {

class Media {
 public:
  explicit Media(int medium = kNone) : now_(static_cast<std::int16_t>(medium)) {}

  [[nodiscard]] int now() const { return now_; }  // index in Scene::media, or kNone
  void enter(int medium) {
    if (levels_ < kMost) outer_[levels_++] = now_;
    now_ = static_cast<std::int16_t>(medium);
  }
  // Where it did not enter, as a ray that begins inside, nothing changes.
  void leave() {
    if (levels_ > 0) now_ = outer_[--levels_];
  }

 private:
  static constexpr std::size_t kMost = 6;  // surfaces within each other
  std::array<std::int16_t, kMost> outer_{};
  std::int16_t now_;
  std::uint16_t levels_ = 0;
};

}  // namespace psf::render
