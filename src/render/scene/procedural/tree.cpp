// A tree: wood as tubes that branch, and places of leaves on its twigs.
#include <array>
#include <cmath>
#include <numbers>

#include "render/scene/procedural/procedural.h"
#include "render/scene/procedural/random.h"
#include "render/scene/shapes.h"

namespace psf::render {
namespace {

using Imath::V3d;

constexpr std::size_t kLevels = 4;  // trunk, boughs, branches, twigs
constexpr std::array<int, kLevels> kPieces = {9, 7, 5, 4};
constexpr std::array<int, kLevels> kFirstChild = {4, 2, 1, 99};  // the lowest piece that branches
constexpr std::array<std::uint32_t, kLevels> kSides = {14, 9, 6, 4};

// Two unit vectors that are upright on the unit vector `n` and on each other.
std::array<V3d, 2> across(const V3d& n) {
  const V3d s = (std::abs(n.y) < 0.9 ? V3d(0, 1, 0) : V3d(1, 0, 0)).cross(n).normalized();
  return {s, n.cross(s)};
}

// The leaf of unit length, from its stalk at the origin along y, its upper side toward z.
Mesh make_leaf() {
  constexpr int kRows = 8;
  Mesh leaf;
  for (int row = 0; row <= kRows; ++row) {
    const double t = static_cast<double>(row) / kRows;
    const double half = 1.25 * t * (1 - t) * (1.25 - 0.5 * t);
    for (int column = -1; column <= 1; ++column) {
      const double x = column * half;
      leaf.positions.emplace_back(static_cast<float>(x), static_cast<float>(t),
                                  static_cast<float>(0.35 * std::abs(x) - 0.25 * t * t));
      leaf.uvs.emplace_back(0.5f + 0.5f * static_cast<float>(column), static_cast<float>(t));
    }
  }
  for (std::uint32_t row = 0; row < kRows; ++row) {
    for (std::uint32_t column = 0; column < 2; ++column) {
      const std::uint32_t a = row * 3 + column, b = a + 1, c = a + 4, d = a + 3;
      // At both ends a row is a point.
      if (row > 0) leaf.triangles.push_back({a, b, c});
      if (row + 1 < kRows) leaf.triangles.push_back({a, c, d});
    }
  }
  leaf.normals = smooth_normals(leaf);
  return leaf;
}

class Growth {
 public:
  explicit Growth(const Tree& tree) : tree_(tree), random_(tree.seed) {}

  TreeParts run() {
    grow(V3d(0), V3d(0, 1, 0), tree_.height * 0.62, tree_.height * 0.03, 0);
    parts_.wood.normals = smooth_normals(parts_.wood);
    parts_.leaf = make_leaf();
    for (std::uint32_t k = 0; k < tree_.leaves; ++k) add_leaf();
    return std::move(parts_);
  }

 private:
  struct Node {
    V3d place, heading;
    double radius;
  };

  void grow(const V3d& from, const V3d& along, double length, double radius, std::size_t level) {
    const int pieces = kPieces[level];
    std::vector<Node> nodes{{from, along, radius}};
    V3d heading = along;
    for (int k = 1; k <= pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      const double lift = level == 0 ? 0.1 : 0.06;
      heading = (heading + random_.on_sphere() * (level == 0 ? 0.12 : 0.22) + V3d(0, lift, 0))
                    .normalized();
      nodes.push_back({nodes.back().place + heading * (length / pieces), heading,
                       radius * (1 - (level + 1 < kLevels ? 0.72 : 0.9) * t)});
    }
    add_tube(nodes, kSides[level]);
    if (level + 1 >= kLevels) return twigs_.push_back(nodes);
    V3d turn = across(along)[0];
    for (int k = kFirstChild[level]; k <= pieces; ++k) {
      const Node& node = nodes[static_cast<std::size_t>(k)];
      const double t = static_cast<double>(k) / pieces;
      for (int side = 0; side < (level == 0 ? 2 : 1); ++side) {
        turn = next_turn(turn, node.heading);
        const double out = k == pieces ? 0.45 : random_.between(0.9, 1.35);
        const V3d child = (node.heading + turn * out).normalized();
        const double radius_there = node.radius * random_.between(0.5, 0.65);
        const double length_there = length * random_.between(0.5, 0.68) * (1.15 - 0.5 * t);
        grow(node.place, child, length_there, radius_there, level + 1);
      }
    }
  }

  // Upright on `heading`, and turned on from the one before by about the golden angle.
  V3d next_turn(const V3d& before, const V3d& heading) {
    constexpr double kCos = -0.7373688780783197, kSin = 0.6754902942615238;
    V3d level = before - heading * before.dot(heading);
    level = level.length2() > 1e-6 ? level.normalized() : across(heading)[0];
    const V3d turned = level * kCos + heading.cross(level) * kSin + random_.on_sphere() * 0.25;
    return (turned - heading * turned.dot(heading)).normalized();
  }

  void add_tube(const std::vector<Node>& nodes, std::uint32_t sides) {
    Mesh& wood = parts_.wood;
    const auto first = static_cast<std::uint32_t>(wood.positions.size());
    V3d s = across(nodes[0].heading)[0];
    for (const Node& node : nodes) {
      // The ring is carried on without a twist.
      s = (s - node.heading * s.dot(node.heading)).normalized();
      const V3d t = node.heading.cross(s);
      for (std::uint32_t k = 0; k < sides; ++k) {
        const double angle = 2 * std::numbers::pi * k / sides;
        wood.positions.push_back(
            Vec3(node.place + (s * std::cos(angle) + t * std::sin(angle)) * node.radius));
        wood.uvs.emplace_back(static_cast<float>(k) / static_cast<float>(sides),
                              static_cast<float>(node.place.y));
      }
    }
    for (std::uint32_t ring = 0; ring + 1 < nodes.size(); ++ring) {
      for (std::uint32_t k = 0; k < sides; ++k) {
        const std::uint32_t a = first + ring * sides + k,
                            b = first + ring * sides + (k + 1) % sides;
        wood.triangles.push_back({a, b, b + sides});
        wood.triangles.push_back({a, b + sides, a + sides});
      }
    }
  }

  void add_leaf() {
    const auto twig = static_cast<std::size_t>(random_.unit() * static_cast<double>(twigs_.size()));
    const std::vector<Node>& nodes = twigs_[twig];
    const double along = random_.between(0.15, 1.0) * static_cast<double>(nodes.size() - 1);
    const auto piece = std::min(static_cast<std::size_t>(along), nodes.size() - 2);
    const double t = along - static_cast<double>(piece);
    const V3d place = nodes[piece].place * (1 - t) + nodes[piece + 1].place * t;
    const V3d y =
        (nodes[piece + 1].heading * 0.5 + random_.on_sphere() * 0.9 + V3d(0, -0.1, 0)).normalized();
    // Most upper sides look up, where the light is.
    V3d z = V3d(0, 1, 0) + random_.on_sphere() * 0.7;
    z -= y * z.dot(y);
    z = z.length2() > 1e-6 ? z.normalized() : across(y)[0];
    const V3d x = y.cross(z);
    const double size = tree_.leaf_size * random_.between(0.65, 1.15);
    parts_.leaves.emplace_back(x.x * size, x.y * size, x.z * size, 0, y.x * size, y.y * size,
                               y.z * size, 0, z.x * size, z.y * size, z.z * size, 0, place.x,
                               place.y, place.z, 1);
  }

  const Tree& tree_;
  Random random_;
  TreeParts parts_;
  std::vector<std::vector<Node>> twigs_;
};

}  // namespace

TreeParts make_tree(const Tree& tree) {
  return Growth(tree).run();
}

}  // namespace psf::render
