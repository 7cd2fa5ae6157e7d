// Shapes of the JSON scene file that are grown from a seed, and curves.
#include "render/scene/procedural/procedural.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "render/scene/copies.h"
#include "render/scene/json/parts.h"

namespace psf::render {

std::uint32_t integer_or(const JsonCursor& json, std::string_view key, std::uint32_t most,
                         std::uint32_t otherwise) {
  const auto found = json.find(key);
  return found ? found->integer(1, most) : otherwise;
}

double real_or(const JsonCursor& json, std::string_view key, const Range& range, double otherwise) {
  const auto found = json.find(key);
  return found ? found->real(range) : otherwise;
}

std::uint64_t read_seed(const JsonCursor& json) {
  const auto seed = json.find("seed");
  return seed ? seed->whole() : 0;
}

namespace {

constexpr std::uint32_t kMaxPieces = 1024;        // of a strand, or between two of its points
constexpr std::uint32_t kMaxCubeSegments = 2048;  // of a noise-sphere
constexpr std::uint32_t kMaxGrown = std::uint32_t{1} << 20;  // strands, leaves, blades
constexpr Range kBend{0, 10, "in [0, 10]"};

// Counts the pieces, of `copies`, before they are made.
std::vector<Strand> read_strands(const JsonCursor& json, std::size_t copies, CopyCount& count) {
  const std::uint32_t pieces = integer_or(json, "segments", kMaxPieces, 8);
  std::vector<Strand> strands;
  std::size_t points_in_all = 0;
  for (const JsonCursor& points : json.at("strands").items()) {
    Strand strand;
    for (const JsonCursor& point : points.items()) {
      const auto v = point.numbers(4);
      if (!(v[3] >= 0)) point.expected("three coordinates and a radius >= 0");
      strand.push_back({{v[0], v[1], v[2]}, v[3]});
      if (strand.size() > 1 && strand.rbegin()[1].position == strand.back().position)
        point.fail("is the same point as the one before");
    }
    if (strand.size() < 2) points.expected("at least two points");
    points_in_all += (strand.size() - 1) * pieces + 1;
    strands.push_back(std::move(strand));
  }
  if (strands.empty()) json.at("strands").expected("at least one strand");
  count.add(json, points_in_all, 0, copies);
  for (Strand& strand : strands) strand = smooth(strand, pieces);
  return strands;
}

Hairball read_hairball(const JsonCursor& json) {
  Hairball hair;
  hair.seed = read_seed(json);
  hair.radius = real_or(json, "radius", kPositive, hair.radius);
  hair.thickness = real_or(json, "thickness", kPositive, hair.radius * hair.thickness);
  hair.curl = real_or(json, "curl", kBend, hair.curl);
  hair.strands = integer_or(json, "strands", kMaxGrown, hair.strands);
  hair.segments = integer_or(json, "segments", kMaxPieces, hair.segments);
  return hair;
}

}  // namespace

void add_curves(const JsonCursor& json, bool hairball, const std::string& name, int material,
                const std::vector<Placement>& placements, JsonLoad& load) {
  std::vector<Strand> strands;
  if (hairball) {
    const Hairball hair = read_hairball(json);
    load.copies.add(json, std::size_t{hair.strands} * hair.segments, 0, placements.size());
    strands = make_hairball(hair);
  } else {
    strands = read_strands(json, placements.size(), load.copies);
  }
  Curves curves;
  curves.name = name;
  curves.material = material;
  for (const Placement& placement : placements) {
    const std::optional<double> scale = even_scale(placement);
    if (!scale || !(*scale > 0)) json.fail("curves can be moved, turned and scaled evenly only");
    for (const Strand& strand : strands) {
      for (std::size_t k = 0; k < strand.size(); ++k) {
        if (k + 1 < strand.size())
          curves.segments.push_back(static_cast<std::uint32_t>(curves.points.size()));
        curves.points.push_back(
            {Vec3(strand[k].position * placement), static_cast<float>(strand[k].radius * *scale)});
      }
    }
  }
  load.scene.curves.push_back(std::move(curves));
}

void add_tree(const JsonCursor& json, const std::string& name, int material,
              const std::vector<Placement>& placements, JsonLoad& load) {
  Tree tree;
  tree.seed = read_seed(json);
  tree.height = real_or(json, "height", kPositive, tree.height);
  tree.leaf_size = real_or(json, "leaf_size", kPositive, tree.height * 0.025);
  tree.leaves = integer_or(json, "leaves", kMaxGrown, tree.leaves);
  if (tree.leaves > kMaxCopies / placements.size()) {
    throw Error(ErrorCode::limit, fmt::format("{}: more than {} leaves", json.where(), kMaxCopies));
  }
  TreeParts parts = make_tree(tree);
  parts.wood.name = name + "/wood";
  parts.wood.material = material;
  add_mesh(json, parts.wood, placements, load);
  parts.leaf.name = name + "/leaf";
  parts.leaf.material = read_material_name(json, load.scene, true, "leaf_material");
  std::vector<Placement> leaves;
  leaves.reserve(parts.leaves.size() * placements.size());
  for (const Placement& placement : placements) {
    for (const Placement& leaf : parts.leaves) leaves.push_back(leaf * placement);
  }
  add_mesh(json, parts.leaf, leaves, load);
}

Mesh read_noise_sphere(const JsonCursor& json) {
  NoiseSphere sphere;
  sphere.seed = read_seed(json);
  sphere.radius = real_or(json, "radius", kPositive, sphere.radius);
  sphere.amplitude = real_or(json, "amplitude", kUnitRange, sphere.amplitude);
  if (const auto frequency = json.find("frequency")) {
    constexpr Range kFrequency{0, 1000, "in [0, 1000]"};
    sphere.frequency = frequency->is_array() ? frequency->vec3d(kFrequency)
                                             : Imath::V3d(frequency->real(kFrequency));
  }
  sphere.octaves = integer_or(json, "octaves", 16, sphere.octaves);
  sphere.segments = integer_or(json, "segments", kMaxCubeSegments, sphere.segments);
  return make_noise_sphere(sphere);
}

Mesh read_tuft(const JsonCursor& json) {
  Tuft tuft;
  tuft.seed = read_seed(json);
  tuft.height = real_or(json, "height", kPositive, tuft.height);
  tuft.spread = real_or(json, "spread", kNonNegative, tuft.height / 4);
  tuft.width = real_or(json, "width", kPositive, tuft.height / 25);
  tuft.bend = real_or(json, "bend", kBend, tuft.bend);
  tuft.blades = integer_or(json, "blades", kMaxGrown, tuft.blades);
  return make_tuft(tuft);
}

std::vector<Placement> read_scatter(const JsonCursor& json) {
  json.check_keys({"count", "seed", "area", "scale"});
  Scatter how;
  how.seed = read_seed(json);
  how.count = json.at("count").integer(1, kMaxCopies);
  const Imath::V2d area = json.at("area").vec2d(kNonNegative);
  how.width = area.x;
  how.depth = area.y;
  if (const auto scale = json.find("scale")) {
    const Imath::V2d range = scale->vec2d(kPositive);
    if (range.x > range.y) scale->expected("the smallest scale and the largest");
    how.least = range.x;
    how.most = range.y;
  }
  return scatter(how);
}

}  // namespace psf::render
