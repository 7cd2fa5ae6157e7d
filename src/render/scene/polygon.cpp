#include "render/scene/polygon.h"

#include <GL/glu.h>

#include <cmath>
#include <new>

namespace psf::render {
namespace {

// GLU carries a pointer with each vertex; ours is the number of the corner, plus 1 as null is none.
void* to_data(std::uint32_t corner) {
  return reinterpret_cast<void*>(std::uintptr_t{corner} + 1);
}
std::uint32_t from_data(const void* data) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(data) - 1);
}

// Newell's normal, of twice the area's length: exact for any plane polygon, fair for a bent one.
Imath::V3d newell_normal(std::span<const Vec3> points, std::span<const std::uint32_t> ring) {
  const Imath::V3d origin(points[ring[0]]);
  Imath::V3d sum(0);
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    sum += (Imath::V3d(points[ring[i]]) - origin).cross(Imath::V3d(points[ring[i + 1]]) - origin);
  return sum;
}

}  // namespace

// A face that crosses itself more often than this times its corners would take too long. GLU has no
// other way out of its sweep than an exception through it.
constexpr std::size_t kMostCrossings = 2;
struct TooManyCrossings {};

struct PolygonCutter::Callbacks {
  static PolygonCutter& of(void* polygon) { return *static_cast<PolygonCutter*>(polygon); }

  static void vertex(void* data, void* polygon) {
    PolygonCutter& cutter = of(polygon);
    cutter.loose_.push_back(from_data(data));
    if (cutter.loose_.size() < 3) return;
    cutter.triangles_.push_back({cutter.loose_[0], cutter.loose_[1], cutter.loose_[2]});
    cutter.loose_.clear();
  }

  // Being there makes GLU give triangles alone, no fans and strips.
  static void edge_flag(GLboolean /*flag*/, void* /*polygon*/) {}

  static void combine(const GLdouble at[3], void* const data[4], const GLfloat weights[4],
                      void** out, void* polygon) {
    PolygonCutter& cutter = of(polygon);
    Crossing crossing{Vec3(Imath::V3d(at[0], at[1], at[2])), {}, {}};
    for (std::size_t i = 0; i < 4 && data[i] != nullptr; ++i) {
      crossing.corners[i] = from_data(data[i]);
      crossing.weights[i] = weights[i];
      // Two corners in one place, as where a hole is cut open, are no crossing.
      if (cutter.position(crossing.corners[i]) == crossing.position) {
        *out = data[i];
        return;
      }
    }
    if (cutter.crossings_.size() > kMostCrossings * cutter.points_.size()) throw TooManyCrossings();
    *out = to_data(static_cast<std::uint32_t>(cutter.points_.size() + cutter.crossings_.size()));
    cutter.crossings_.push_back(crossing);
  }

  static void error(GLenum /*error*/, void* polygon) { of(polygon).failed_ = true; }
};

void PolygonCutter::Delete::operator()(GLUtesselator* tess) const {
  gluDeleteTess(tess);
}

PolygonCutter::PolygonCutter() : tess_(gluNewTess()) {
  if (tess_ == nullptr) throw std::bad_alloc();
  const auto set = [this](GLenum which, auto* function) {
    gluTessCallback(tess_.get(), which, reinterpret_cast<_GLUfuncptr>(function));
  };
  set(GLU_TESS_VERTEX_DATA, &Callbacks::vertex);
  set(GLU_TESS_EDGE_FLAG_DATA, &Callbacks::edge_flag);
  set(GLU_TESS_COMBINE_DATA, &Callbacks::combine);
  set(GLU_TESS_ERROR_DATA, &Callbacks::error);
  gluTessProperty(tess_.get(), GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_NONZERO);
}

PolygonCutter::~PolygonCutter() = default;

Vec3 PolygonCutter::position(std::uint32_t corner) const {
  return corner < points_.size() ? points_[corner] : crossings_[corner - points_.size()].position;
}

bool PolygonCutter::cut(std::span<const Vec3> points) {
  points_ = points;
  triangles_.clear();
  crossings_.clear();
  ring_.clear();
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (ring_.empty() || points[i] != points[ring_.back()]) ring_.push_back(i);
  }
  while (ring_.size() > 1 && points[ring_.back()] == points[ring_[0]]) ring_.pop_back();
  repeats_ = ring_.size() < points.size();
  if (points.size() == 3 || ring_.size() < 3) {
    triangles_.push_back({0, 1, 2});
    return true;
  }
  if (ring_.size() == 3) {
    triangles_.push_back({ring_[0], ring_[1], ring_[2]});
    return true;
  }
  const Imath::V3d normal = newell_normal(points, ring_);
  return (ring_.size() == 4 && cut_convex_quad(normal)) || tessellate(normal);
}

// Most faces of most files. Along the shorter diagonal, which bends less where they are not plane.
bool PolygonCutter::cut_convex_quad(const Imath::V3d& normal) {
  std::array<Imath::V3d, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = Imath::V3d(points_[ring_[i]]);
  for (std::size_t i = 0; i < 4; ++i) {
    const Imath::V3d along = p[(i + 1) & 3] - p[i], next = p[(i + 2) & 3] - p[(i + 1) & 3];
    if (!(along.cross(next).dot(normal) > 0)) return false;
  }
  const std::size_t start = (p[2] - p[0]).length2() <= (p[3] - p[1]).length2() ? 0 : 1;
  const auto corner = [&](std::size_t i) { return ring_[(start + i) & 3]; };
  triangles_.push_back({corner(0), corner(1), corner(2)});
  triangles_.push_back({corner(0), corner(2), corner(3)});
  return true;
}

bool PolygonCutter::tessellate(const Imath::V3d& normal) {
  failed_ = false;
  loose_.clear();
  // No normal, as of a bow tie, lets GLU choose one.
  try {
    gluTessNormal(tess_.get(), normal.x, normal.y, normal.z);
    gluTessBeginPolygon(tess_.get(), this);
    gluTessBeginContour(tess_.get());
    for (const std::uint32_t corner : ring_) {
      std::array<GLdouble, 3> at{};
      for (int axis = 0; axis < 3; ++axis)
        at[static_cast<std::size_t>(axis)] = double{points_[corner][axis]};
      gluTessVertex(tess_.get(), at.data(), to_data(corner));
    }
    gluTessEndContour(tess_.get());
    gluTessEndPolygon(tess_.get());
  } catch (const TooManyCrossings&) {
    return false;  // what GLU held of this face is lost
  }
  return !failed_;
}

}  // namespace psf::render
