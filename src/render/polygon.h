// Cuts faces of any number of corners into triangles, by GLU's tessellator: it is right for concave
// faces and those with a hole cut open, and finds where a face crosses itself.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/vec.h"

struct GLUtesselator;

namespace psf::render {

// A point where edges of a face cross: the mean of up to four corners or earlier crossings.
struct Crossing {
  Vec3 position;
  std::array<std::uint32_t, 4> corners{};
  std::array<float, 4> weights{};  // 0 for those that do not count
};

class PolygonCutter {
 public:
  PolygonCutter();
  ~PolygonCutter();
  PolygonCutter(const PolygonCutter&) = delete;
  PolygonCutter& operator=(const PolygonCutter&) = delete;

  // `points`: at least three corners in order, finite, in a plane or near one. The triangles are
  // wound as the face is and cover what it goes around (nonzero winding). A corner that is where
  // the one before it is does not count; a face with fewer than three others becomes one triangle
  // without area. False where it crosses itself more than twice
  // for each corner.
  [[nodiscard]] bool cut(std::span<const Vec3> points);

  // Numbers below points.size() are corners, the others, less that, crossings.
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 3>>& triangles() const {
    return triangles_;
  }
  [[nodiscard]] const std::vector<Crossing>& crossings() const { return crossings_; }
  [[nodiscard]] bool repeats() const { return repeats_; }  // a corner did not count

 private:
  struct Callbacks;
  struct Delete {
    void operator()(GLUtesselator* tess) const;
  };
  [[nodiscard]] Vec3 position(std::uint32_t corner) const;
  [[nodiscard]] bool cut_convex_quad(const Imath::V3d& normal);
  [[nodiscard]] bool tessellate(const Imath::V3d& normal);

  std::unique_ptr<GLUtesselator, Delete> tess_;
  std::span<const Vec3> points_;
  std::vector<std::uint32_t> ring_;   // the corners that count
  std::vector<std::uint32_t> loose_;  // corners of the triangle that is not whole yet
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Crossing> crossings_;
  bool repeats_ = false, failed_ = false;
};

}  // namespace psf::render
