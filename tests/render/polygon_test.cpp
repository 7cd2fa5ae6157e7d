// Faces cut into triangles, against the shoelace formula and the even-odd rule.
#include "render/scene/polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "catch.h"

namespace psf::render {
namespace {

struct Point {
  double x, y;
};
using Outline = std::vector<Point>;

double shoelace(const Outline& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Point &a = p[i], &b = p[(i + 1) % p.size()];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum / 2;
}

// Even-odd rule; of no meaning on an edge.
bool is_inside(const Outline& p, const Point& q) {
  bool inside = false;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Point &a = p[i], &b = p[(i + 1) % p.size()];
    if ((a.y > q.y) != (b.y > q.y) && q.x < a.x + (q.y - a.y) / (b.y - a.y) * (b.x - a.x))
      inside = !inside;
  }
  return inside;
}

// A plane in space: where (x, y) of an outline goes. The axes are unit and at right angles.
struct Plane {
  Imath::V3d origin, u, v;
};
const Plane kPlanes[] = {
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
    {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}},  // seen from behind
    {{1, 2, 3}, {0, 0, 1}, {1, 0, 0}},
    {{-4, 0, 2}, {0, 0.6, 0.8}, {0, -0.8, 0.6}},
    {{3, -1, 5}, {2.0 / 3, -1.0 / 3, 2.0 / 3}, {2.0 / 3, 2.0 / 3, -1.0 / 3}},
};

std::vector<Vec3> placed(const Outline& outline, const Plane& plane) {
  std::vector<Vec3> points;
  for (const Point& p : outline)
    points.emplace_back(Vec3(plane.origin + plane.u * p.x + plane.v * p.y));
  return points;
}

Outline rotated(Outline p, std::size_t by) {
  std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(by), p.end());
  return p;
}
Outline reversed(Outline p) {
  std::reverse(p.begin(), p.end());
  return p;
}

struct Cut {
  double area = 0;            // sum of the areas of all triangles, each positive
  std::vector<Outline> flat;  // the triangles back in the plane
  std::size_t backward = 0;   // triangles that are wound against the face
  std::size_t crossings = 0;
  bool repeats = false;
};

Cut cut(const Outline& outline, const Plane& plane, double sign) {
  static PolygonCutter cutter;
  const std::vector<Vec3> points = placed(outline, plane);
  REQUIRE(cutter.cut(points));
  Cut result;
  result.crossings = cutter.crossings().size();
  result.repeats = cutter.repeats();
  for (const auto& triangle : cutter.triangles()) {
    Outline flat;
    for (const std::uint32_t i : triangle) {
      const Imath::V3d at =
          Imath::V3d(i < points.size() ? points[i]
                                       : cutter.crossings()[i - points.size()].position) -
          plane.origin;
      flat.push_back({at.dot(plane.u), at.dot(plane.v)});
    }
    const double area = shoelace(flat);
    result.area += std::abs(area);
    if (area * sign < 0) ++result.backward;
    result.flat.push_back(std::move(flat));
  }
  return result;
}

// Every first corner, both windings, every plane: the area, the winding, and each point inside in
// one triangle, each outside in none.
void check_simple(const std::string& name, const Outline& outline) {
  const double area = std::abs(shoelace(outline));
  std::mt19937 generator(3);
  double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9;
  for (const Point& p : outline) {
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  }
  std::uniform_real_distribution<double> x(x0 - 0.1, x1 + 0.1), y(y0 - 0.1, y1 + 0.1);
  for (const Plane& plane : kPlanes) {
    for (std::size_t start = 0; start < outline.size(); ++start) {
      for (const bool backward : {false, true}) {
        const Outline p = rotated(backward ? reversed(outline) : outline, start);
        CAPTURE(name, start, backward, plane.u, plane.v);
        const Cut result = cut(p, plane, shoelace(p));
        CHECK(result.area == Approx(area).epsilon(1e-5));
        CHECK(result.backward == 0);
        CHECK(result.crossings == 0);
        std::size_t wrong = 0;
        for (int k = 0; k < 40; ++k) {
          const Point q{x(generator), y(generator)};
          const auto covers = std::count_if(result.flat.begin(), result.flat.end(),
                                            [&](const Outline& t) { return is_inside(t, q); });
          if (covers != (is_inside(p, q) ? 1 : 0)) ++wrong;
        }
        CHECK(wrong == 0);
      }
    }
  }
}

// Corners on a circle, of random distance from its centre: simple whatever comes.
Outline star(std::mt19937& generator, int corners) {
  std::uniform_real_distribution<double> radius(0.2, 2);
  Outline p;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, r = radius(generator);
    p.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return p;
}

const Outline kArrow = {{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}};
const Outline kBracket = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {3, 2}, {3, 3}, {0, 3}};

}  // namespace

TEST_CASE("concave faces keep their area from any first corner, in both windings, in any plane",
          "[load][polygon]") {
  check_simple("triangle", {{0, 0}, {2, 0}, {0, 1}});
  check_simple("square", {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  check_simple("dart", {{0, 0}, {4, 0}, {1, 1}, {0, 4}});
  check_simple("arrow", kArrow);
  check_simple("bracket", kBracket);
  check_simple("cross", {{1, 0},
                         {2, 0},
                         {2, 1},
                         {3, 1},
                         {3, 2},
                         {2, 2},
                         {2, 3},
                         {1, 3},
                         {1, 2},
                         {0, 2},
                         {0, 1},
                         {1, 1}});
  check_simple("ladder", {{0, 0},
                          {1, 0},
                          {1, 1},
                          {2, 1},
                          {2, 0},
                          {3, 0},
                          {3, 3},
                          {2, 3},
                          {2, 2},
                          {1, 2},
                          {1, 3},
                          {0, 3}});
  check_simple("comb", {{0, 0}, {7, 0}, {7, 3}, {6, 1}, {5, 3}, {4, 1}, {3, 3}, {2, 1}, {1, 3}});
  check_simple("spiral", {{0, 0},
                          {5, 0},
                          {5, 5},
                          {1, 5},
                          {1, 2},
                          {3, 2},
                          {3, 3},
                          {2, 3},
                          {2, 4},
                          {4, 4},
                          {4, 1},
                          {0, 1}});
  check_simple("corners in a line",
               {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {2, 3}, {1, 3}, {0, 3}});
  check_simple("needle", {{0, 0}, {64, 0}, {64, 1}, {32, 0.5}, {0, 1}});
  std::mt19937 generator(17);
  for (const int corners : {5, 8, 13, 40}) check_simple("star", star(generator, corners));
}

TEST_CASE("a hole that is cut open stays a hole", "[load][polygon]") {
  // Out around a square of 16, in to one of 4 and around it the other way, and back.
  const Outline keyhole = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0},
                           {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}};
  for (const Plane& plane : kPlanes) {
    for (std::size_t start = 0; start < keyhole.size(); ++start) {
      for (const bool backward : {false, true}) {
        const Outline p = rotated(backward ? reversed(keyhole) : keyhole, start);
        CAPTURE(start, backward);
        const Cut result = cut(p, plane, shoelace(p));
        CHECK(result.area == Approx(12).epsilon(1e-6));
        CHECK(result.backward == 0);
        CHECK(result.crossings == 0);
        CHECK(std::none_of(result.flat.begin(), result.flat.end(), [](const Outline& t) {
          return is_inside(t, {2.01, 2.02});
        }));
      }
    }
  }
}

TEST_CASE("corners that repeat the one before them do not count", "[load][polygon]") {
  for (std::size_t at = 0; at < kArrow.size(); ++at) {
    Outline p = kArrow;
    p.insert(p.begin() + static_cast<std::ptrdiff_t>(at), 2, kArrow[at]);
    const Cut result = cut(p, kPlanes[0], 1);
    CHECK(result.repeats);
    CHECK(result.area == Approx(shoelace(kArrow)).epsilon(1e-6));
    CHECK(result.flat.size() == kArrow.size() - 2);
  }
  CHECK_FALSE(cut(kArrow, kPlanes[0], 1).repeats);
  const Cut line = cut({{0, 0}, {1, 0}, {1, 0}, {0, 0}}, kPlanes[0], 1);
  CHECK(line.flat.size() == 1);
  CHECK(line.area == 0);
}

TEST_CASE("a face that crosses itself shows all that it goes around, and tells where",
          "[load][polygon]") {
  for (const Plane& plane : kPlanes) {
    // Two triangles of area 1 that meet at (1, 1), of opposite windings.
    const Cut bow = cut({{0, 0}, {2, 2}, {2, 0}, {0, 2}}, plane, 1);
    CHECK(bow.area == Approx(2).epsilon(1e-6));
    CHECK(bow.crossings == 1);
    // A five-pointed star in one stroke: its five points and what lies between them.
    Outline pentagram, rim;
    for (int i = 0; i < 5; ++i) {
      const double angle = 4 * std::numbers::pi / 5 * i;
      pentagram.push_back({std::cos(angle), std::sin(angle)});
    }
    const double inner = (3 - std::sqrt(5.0)) / 2;
    for (int i = 0; i < 10; ++i) {
      const double angle = std::numbers::pi / 5 * i, r = i % 2 == 0 ? 1 : inner;
      rim.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    const Cut points = cut(pentagram, plane, 1);
    CHECK(points.area == Approx(shoelace(rim)).epsilon(1e-5));
    CHECK(points.crossings == 5);
    CHECK(points.backward == 0);
  }
}

TEST_CASE("a face that crosses itself everywhere is refused at once, and the next one is cut",
          "[load][polygon]") {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform;
  std::vector<Vec3> scribble;
  for (int i = 0; i < 4000; ++i) {
    const float x = uniform(generator), y = uniform(generator);
    scribble.emplace_back(x, y, 0.0f);
  }
  PolygonCutter cutter;
  CHECK_FALSE(cutter.cut(scribble));
  CHECK(cutter.crossings().size() < 10000);
  CHECK(cutter.cut(placed(kArrow, kPlanes[0])));
  CHECK(cutter.triangles().size() == 3);
  CHECK(cutter.crossings().empty());
}

}  // namespace psf::render

// What GLU held of a face that it gave up.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libGLU";
}
