// Cuts faces of any number of corners into triangles, by GLU's tessellator. It handles concave
// faces and faces whose hole is cut open, and finds the points where a face crosses itself.
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
  std::array<float, 4> weights{};  // 0 for unused corners
};

class PolygonCutter {
 public:
  PolygonCutter();
  ~PolygonCutter();
  PolygonCutter(const PolygonCutter&) = delete;
  PolygonCutter& operator=(const PolygonCutter&) = delete;

  // Cuts a face. `points`: at least three corners in order, finite, in a plane or near one. The
  // triangles have the winding of the face and cover the area that it encloses (nonzero winding). A
  // corner at the position of the one before it is skipped; a face with fewer than three other
  // corners becomes one triangle without area. Returns false where the face crosses itself more
  // than twice for each corner.
  [[nodiscard]] bool cut(std::span<const Vec3> points);

  // A number k below points.size() is corner k; any other is crossing k - points.size().
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 3>>& triangles() const {
    return triangles_;
  }
  [[nodiscard]] const std::vector<Crossing>& crossings() const { return crossings_; }
  [[nodiscard]] bool repeats() const { return repeats_; }  // a corner was skipped

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
  std::vector<std::uint32_t> ring_;   // the corners that were not skipped
  std::vector<std::uint32_t> loose_;  // corners of the unfinished triangle
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Crossing> crossings_;
  bool repeats_ = false, failed_ = false;
};

}  // namespace psf::render
