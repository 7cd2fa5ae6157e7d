#include "explain/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/output_file.h"
#include "explain/words.h"
#include "export/file.h"
#include "export/ply_header.h"
#include "filter/weights.h"

namespace psf::explain {
namespace {

enum class Kind { own, averaged, refused, giving };

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
    if (pair.given > 0 && point.kind != Kind::averaged) point.kind = Kind::giving;
    point.refused_by &= brings_light(pair) ? 0 : pair.refusers;
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
  while (k < filter::kTermCount && ((of >> k) & 1) == 0) ++k;
  return k;
}

// The vertices of a file, one row each.
class Rows {
 public:
  Rows(const ExplainResult& explanation, const Attribution& whence)
      : e_(explanation), pixel_(luminance(whence.pixel.filtered)), any_(e_.record.size(), 0) {
    for (const ExplainedPair& pair : e_.pairs) any_[pair.vertex] |= pair.refusers;
    for (const SourceShare& source : whence.sources) {
      largest_ = std::max(largest_, fraction(source.share));
    }
  }

  // The properties of a row.
  [[nodiscard]] std::vector<exports::PlyProperty> properties() const {
    std::vector<exports::PlyProperty> all;
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) all.push_back({"float", name});
    for (const char* name : {"red", "green", "blue"}) all.push_back({"uchar", name});
    for (const char* name :
         {"kind", "share", "excess", "paths", "distance", "refused_by", "x", "y"}) {
      all.push_back({"float", std::string("scalar_") + name});
    }
    all.push_back({"double", "scalar_record"});
    if (dims(e_)) {
      for (const char* name : {"scalar_kept", "scalar_given"}) all.push_back({"float", name});
    }
    return all;
  }

  void add(std::uint32_t v, const Point& point) {
    const SourceShare none;
    const SourceShare& source = point.source != nullptr ? *point.source : none;
    const double share = fraction(source.share);
    const Vec3& x = e_.vertices.position[v];
    const Vec3 n = e_.vertices.normal.empty() ? Vec3(0, 0, 0) : e_.vertices.normal[v];
    for (const float value : {x.x, x.y, x.z, n.x, n.y, n.z}) put(value);
    for (const std::uint8_t value : colour(v, point, share)) put(value);
    const std::uint16_t camera = e_.vertices.camera.empty() ? 0 : e_.vertices.camera[v];
    const std::uint32_t width = e_.widths[camera];
    for (const double value :
         {static_cast<double>(point.kind), share, fraction(source.excess),
          static_cast<double>(source.paths), double{point.distance},
          static_cast<double>(point.refused_by), static_cast<double>(e_.vertices.pixel[v] % width),
          static_cast<double>(e_.vertices.pixel[v] / width)}) {
      put(static_cast<float>(value));
    }
    put(static_cast<double>(e_.record[v]));
    if (dims(e_)) {
      const ExplainedFirefly* firefly = firefly_at(e_, v);
      put(firefly != nullptr ? firefly->kept : 1.0f);
      put(static_cast<float>(fraction(source.given)));
    }
    ++count_;
  }

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  template <typename T>
  void put(T value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof value);
  }

  // Of the pixel.
  [[nodiscard]] double fraction(const Colour& colour) const {
    return pixel_ > 0 ? luminance(colour) / pixel_ : 0;
  }

  [[nodiscard]] std::array<std::uint8_t, 3> colour(std::uint32_t v, const Point& point,
                                                   double share) const {
    if (point.kind == Kind::own) return {255, 0, 0};
    if (point.kind == Kind::refused) {
      const auto& of = kTermColours[first_term(point.refused_by, any_[v])];
      return {of[0], of[1], of[2]};
    }
    const double root = largest_ > 0 && share > 0 ? std::sqrt(share / largest_) : 0;
    const auto grey = static_cast<std::uint8_t>(std::lround(70 + 185 * std::min(root, 1.0)));
    return {grey, grey, grey};
  }

  const ExplainResult& e_;
  double pixel_;                    // luminance
  std::vector<std::uint32_t> any_;  // by vertex: the terms that refuse it in some ball
  double largest_ = 0;              // fraction of a source
  std::uint64_t count_ = 0;
  std::vector<std::byte> bytes_;
};

}  // namespace

std::uint64_t write_ply(const ExplainResult& explanation, const Attribution& whence,
                        const std::string& path) {
  const std::vector<Point> points = points_of(explanation, whence);
  Rows rows(explanation, whence);
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    if (points[v].used) rows.add(v, points[v]);
  }
  core::OutputFile output(path);
  exports::ExportFile file(output.temporary_path(), path);
  file.write(exports::ply_header("psf explain: the vertices that play a part in a pixel",
                                 rows.count(), rows.properties()));
  file.write(rows.bytes());
  file.close();
  output.commit();
  return rows.count();
}

}  // namespace psf::explain
