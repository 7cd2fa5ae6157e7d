#include "explain/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/output_file.h"
#include "export/file.h"
#include "export/ply_header.h"
#include "filter/weights.h"

namespace psf::explain {
namespace {

enum class Kind { own, averaged, refused };

struct Point {
  Kind kind = Kind::refused;
  bool used = false;
  std::uint32_t refused_by = ~0u;
  float distance = std::numeric_limits<float>::infinity();
  const SourceShare* source = nullptr;
};

std::vector<Point> points_of(const ExplainResult& e, const Attribution& whence) {
  std::vector<Point> points(e.record.size());
  for (const ExplainedPair& pair : e.pairs) {
    Point& point = points[pair.vertex];
    point.used = true;
    if (pair.averaged) point.kind = Kind::averaged;
    point.refused_by &= pair.averaged ? 0 : pair.refusers;
    point.distance = std::min(point.distance, pair.distance);
  }
  for (const ExplainedPath& path : e.paths) {
    const bool vertex = path.fate != PathFate::no_vertex && path.fate != PathFate::left_out;
    Point& point = points[path.vertex];
    point.used = vertex;
    point.kind = Kind::own;
    point.refused_by = 0;
    point.distance = 0;
  }
  for (const SourceShare& source : whence.sources) points[source.vertex].source = &source;
  return points;
}

// The lowest term of `bits`, the terms that refuse a vertex in every ball. Where there is none,
// because different terms refuse it in different balls, the lowest term of `any`.
std::size_t first_term(std::uint32_t bits, std::uint32_t any) {
  const std::uint32_t of = bits != 0 ? bits : any;
  std::size_t k = 0;
  while (k < filter::kTermCount - 1 && ((of >> k) & 1) == 0) ++k;
  return k;
}

class Rows {
 public:
  template <typename T>
  void put(T value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof value);
  }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace

std::uint64_t write_ply(const ExplainResult& explanation, const Attribution& whence,
                        const std::string& path) {
  const ExplainResult& e = explanation;
  const std::vector<Point> points = points_of(e, whence);
  std::vector<std::uint32_t> any(e.record.size(), 0);
  for (const ExplainedPair& pair : e.pairs) any[pair.vertex] |= pair.refusers;
  const double pixel = luminance(whence.pixel.filtered);
  const auto fraction = [pixel](const Colour& colour) {
    return pixel > 0 ? luminance(colour) / pixel : 0;
  };
  double largest = 0;
  for (const SourceShare& source : whence.sources) {
    largest = std::max(largest, fraction(source.share));
  }

  Rows rows;
  std::uint64_t count = 0;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    const Point& point = points[v];
    if (!point.used) continue;
    ++count;
    const SourceShare none;
    const SourceShare& source = point.source != nullptr ? *point.source : none;
    const double share = fraction(source.share);
    const Vec3& x = e.vertices.position[v];
    const Vec3 n = e.vertices.normal.empty() ? Vec3(0, 0, 0) : e.vertices.normal[v];
    for (const float value : {x.x, x.y, x.z, n.x, n.y, n.z}) rows.put(value);
    std::array<std::uint8_t, 3> colour = {255, 0, 0};
    if (point.kind == Kind::refused) {
      const auto& of = kTermColours[first_term(point.refused_by, any[v])];
      colour = {of[0], of[1], of[2]};
    } else if (point.kind == Kind::averaged) {
      const double root = largest > 0 && share > 0 ? std::sqrt(share / largest) : 0;
      colour.fill(static_cast<std::uint8_t>(std::lround(70 + 185 * std::min(root, 1.0))));
    }
    for (const std::uint8_t value : colour) rows.put(value);
    const std::uint16_t camera = e.vertices.camera.empty() ? 0 : e.vertices.camera[v];
    const std::uint32_t width = e.widths[camera];
    for (const double value :
         {static_cast<double>(point.kind), share, fraction(source.excess),
          static_cast<double>(source.paths), double{point.distance},
          static_cast<double>(point.refused_by), static_cast<double>(e.vertices.pixel[v] % width),
          static_cast<double>(e.vertices.pixel[v] / width)}) {
      rows.put(static_cast<float>(value));
    }
    rows.put(static_cast<double>(e.record[v]));
  }

  std::vector<exports::PlyProperty> properties;
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) properties.push_back({"float", name});
  for (const char* name : {"red", "green", "blue"}) properties.push_back({"uchar", name});
  for (const char* name :
       {"kind", "share", "excess", "paths", "distance", "refused_by", "x", "y"}) {
    properties.push_back({"float", std::string("scalar_") + name});
  }
  properties.push_back({"double", "scalar_record"});
  core::OutputFile output(path);
  exports::ExportFile file(output.temporary_path(), path);
  file.write(exports::ply_header("psf explain: the vertices that play a part in a pixel", count,
                                 properties));
  file.write(rows.bytes());
  file.close();
  output.commit();
  return count;
}

}  // namespace psf::explain
