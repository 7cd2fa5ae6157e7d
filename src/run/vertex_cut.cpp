#include "run/vertex_cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "filter/records.h"
#include "run/path_radiance.h"
#include "run/table_channel.h"

namespace psf::run {
namespace {

constexpr std::size_t kPathsAtOnce = 8192;
constexpr std::uint64_t kRowsAtOnce = 32768;  // unless one path has more
constexpr std::uint8_t kSelected = 1;         // bit of the channel `flags` of a vertex
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

const formats::TableReader& vertices_of(const formats::Reader& reader) {
  if (const formats::TableReader* table = reader.find_table("vertices")) return *table;
  throw Error(
      ErrorCode::bad_input,
      fmt::format("{}: has no vertices to choose from; render with --vertices all", reader.path()));
}

}  // namespace

// Columns of consecutive rows; those that nothing asks for are empty.
struct VertexCut::Vertices {
  std::vector<std::uint32_t> path, parent, material;
  std::vector<std::uint8_t> flags, kind;
  std::vector<Vec3> position, normal, direction;
  std::vector<Rgb> throughput, emission, direct, background, reflectance;
  std::vector<float> distance, roughness;
};

VertexCut::VertexCut(const formats::Reader& reader, const VertexRule& rule,
                     std::uint32_t shade_rate)
    : reader_(reader), table_(vertices_of(reader)), rule_(rule), all_shaded_(shade_rate <= 1) {
  static_cast<void>(read(0, 0, {}));  // what every choice looks at is there
}

bool VertexCut::has(std::string_view channel) const {
  if (rule_.kind == VertexRule::Kind::first_rough) return true;
  if (channel == "hit_distance") return table_.schema().find("distance").has_value();
  if (channel == "throughput" || channel == "contribution" || channel == "unfiltered" ||
      channel == "pixel" || channel == "camera" || channel == "flags" || channel == "alpha") {
    return true;
  }
  return channel != "visibility" && table_.schema().find(channel).has_value();
}

bool VertexCut::makes_kind() const {
  return rule_.kind != VertexRule::Kind::first_rough && table_.schema().find("kind") &&
         !reader_.head().find("kind");
}

void VertexCut::apply(const filter::PathRange& range, BlockRecords& out) const {
  const auto passes = reader_.passes();
  // A file without u has u = 0 for the vertex that the renderer selected, and not for others.
  if (out.unfiltered.empty()) out.unfiltered.assign(static_cast<std::size_t>(range.size()), Rgb(0));
  if (makes_kind()) out.kind.assign(static_cast<std::size_t>(range.size()), 0);
  for (std::size_t pass = 0; pass < passes.size(); ++pass) {
    const std::uint64_t first = std::max(passes[pass].first, range.first);
    const std::uint64_t last = std::min(passes[pass].first + passes[pass].count, range.last);
    if (first >= last) continue;
    if (table_.passes()[pass].count == 0) {
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: pass {} has no vertices; choose other passes, or do without a "
                              "choice of the vertex",
                              reader_.path(), pass));
    }
    core::parallel_for(static_cast<std::size_t>(last - first), kPathsAtOnce,
                       [&](std::size_t begin, std::size_t end) {
                         // A thread that waits for its reader does not begin with other paths.
                         core::undisturbed([&] {
                           cut(pass, first + begin, first + end,
                               static_cast<std::size_t>(first - range.first) + begin, out);
                         });
                       });
  }
}

std::uint64_t VertexCut::memory() const {
  std::uint64_t chunk = 0, widest = 0;
  for (const formats::ChunkEntry& entry : table_.chunks()) {
    chunk = std::max<std::uint64_t>(chunk, entry.count);
  }
  for (const formats::Channel& channel : table_.schema().channels) {
    widest = std::max<std::uint64_t>(widest, channel.stride());
  }
  constexpr std::uint64_t kRow = 3 * sizeof(std::uint32_t) + 2 * sizeof(std::uint8_t) +
                                 3 * sizeof(Vec3) + 5 * sizeof(Rgb) + 2 * sizeof(float);
  // A column as stored, in its own order and in that of the file, as the reader of paths has them.
  constexpr std::uint64_t kColumns = 3;
  const std::uint64_t kept = std::min<std::uint64_t>(formats::TableReader::kCacheBytes,
                                                     table_.records() * table_.schema().stride());
  return core::thread_count() * (kRowsAtOnce * kRow + kColumns * chunk * widest) + kept +
         2 * table_.chunks().size() * sizeof(formats::ChunkEntry) +
         table_.passes().size() * sizeof(formats::Pass);
}

// Paths [first, last) of a pass, which are the records from `place` on.
void VertexCut::cut(std::uint64_t pass, std::uint64_t first, std::uint64_t last, std::size_t place,
                    BlockRecords& out) const {
  const std::uint64_t start = reader_.passes()[pass].first;
  const formats::Pass& rows = table_.passes()[pass];
  const std::uint64_t from = row_of(rows, static_cast<std::uint32_t>(first - start));
  const std::uint64_t to = row_of(rows, static_cast<std::uint32_t>(last - start));
  if (to - from > kRowsAtOnce && last - first > 1) {
    const std::uint64_t half = first + (last - first) / 2;
    cut(pass, first, half, place, out);
    return cut(pass, half, last, place + static_cast<std::size_t>(half - first), out);
  }
  const Vertices vertices = read(from, to, out);
  std::size_t row = 0;
  while (row < vertices.path.size()) {
    std::size_t end = row + 1;
    while (end < vertices.path.size() && vertices.path[end] == vertices.path[row]) ++end;
    if (vertices.path[row] < first - start || vertices.path[row] >= last - start) {
      fail(from + row, "its path is out of order");
    }
    if (vertices.parent[row] != 0) fail(from + row, "the first vertex of a path has a parent");
    for (std::size_t k = row + 1; k < end; ++k) {
      if (vertices.parent[k] != 1) fail(from + k, "paths that split have no one vertex to choose");
    }
    cut_path(vertices, row, end,
             place + vertices.path[row] - static_cast<std::size_t>(first - start), out);
    row = end;
  }
}

// The first row of a pass whose path is at least `path`.
std::uint64_t VertexCut::row_of(const formats::Pass& rows, std::uint32_t path) const {
  const std::size_t channel = *table_.schema().find("path");
  std::uint64_t first = rows.first, count = rows.count;
  while (count > 0) {
    const std::uint64_t half = count / 2;
    std::uint32_t there = 0;
    table_.read(channel, first + half, 1, std::as_writable_bytes(std::span(&there, 1)));
    if (there < path) {
      first += half + 1;
      count -= half + 1;
    } else {
      count = half;
    }
  }
  return first;
}

VertexCut::Vertices VertexCut::read(std::uint64_t first, std::uint64_t last,
                                    const BlockRecords& out) const {
  Vertices rows;
  const auto count = static_cast<std::size_t>(last - first);
  const auto place = [this](const char* name, formats::Type type, std::size_t components) {
    return table_channel(reader_, table_, name, type, components, "the choice of a vertex");
  };
  const auto numbers = [&](const char* name, auto& column) {
    const bool bytes = sizeof(column[0]) == 1;
    const std::size_t at = place(name, bytes ? formats::Type::u8 : formats::Type::u32, 1);
    column.resize(count);
    table_.read(at, first, count, std::as_writable_bytes(std::span(column)));
  };
  const auto floats = [&](const char* name, auto& column) {
    constexpr std::size_t kComponents = sizeof(column[0]) / sizeof(float);
    const std::size_t at = place(name, formats::Type::f32, kComponents);
    column.resize(count);
    auto* values = static_cast<float*>(static_cast<void*>(column.data()));
    table_.read_floats(at, first, count, {values, count * kComponents});
  };
  numbers("path", rows.path);
  numbers("parent", rows.parent);
  numbers("flags", rows.flags);
  floats("throughput", rows.throughput);
  floats("emission", rows.emission);
  floats("direct", rows.direct);
  floats("background", rows.background);
  floats("position", rows.position);
  const bool distances = rule_.kind == VertexRule::Kind::distance || !out.distance.empty() ||
                         !out.hit_distance.empty();
  if (distances) floats("distance", rows.distance);
  if (!out.normal.empty()) floats("normal", rows.normal);
  if (!out.direction.empty()) floats("direction", rows.direction);
  if (!out.reflectance.empty()) floats("reflectance", rows.reflectance);
  if (!out.material.empty()) numbers("material", rows.material);
  if (!out.kind.empty() && rule_.kind != VertexRule::Kind::first_rough) numbers("kind", rows.kind);
  if (rule_.kind == VertexRule::Kind::roughness || !out.roughness.empty()) {
    floats("roughness", rows.roughness);
  }
  return rows;
}

// The row of the vertex of a path; kNone where there is none.
std::size_t VertexCut::select(const Vertices& rows, std::size_t first, std::size_t last) const {
  double length = 0;
  for (std::size_t k = first; k < last; ++k) {
    switch (rule_.kind) {
      case VertexRule::Kind::first_rough:
        if ((rows.flags[k] & kSelected) != 0) return k;
        break;
      case VertexRule::Kind::depth:
        if (static_cast<double>(k - first) == rule_.value) return k;
        break;
      case VertexRule::Kind::roughness:
        if (static_cast<double>(rows.roughness[k]) >= rule_.value) return k;
        break;
      case VertexRule::Kind::distance:
        length += static_cast<double>(rows.distance[k]);
        if (length >= rule_.value) return k;
        break;
    }
  }
  return kNone;
}

void VertexCut::cut_path(const Vertices& rows, std::size_t first, std::size_t last, std::size_t i,
                         BlockRecords& out) const {
  const std::size_t v = select(rows, first, last);
  const std::uint8_t before = out.flags[i];
  if (v == kNone) {
    if ((before & filter::kHasVertex) == 0) return;
    out.unfiltered[i] = path_radiance(out.unfiltered[i], out.throughput[i], out.contribution[i]);
    out.flags[i] = static_cast<std::uint8_t>(before & ~filter::kHasVertex);
    out.throughput[i] = out.contribution[i] = Rgb(0, 0, 0);
    return;
  }
  if (!rows.kind.empty()) out.kind[i] = rows.kind[v];
  if ((rows.flags[v] & kSelected) != 0 && (before & filter::kHasVertex) != 0) return;
  const bool shaded = all_shaded_ || (before & filter::kShaded) != 0;
  out.flags[i] = static_cast<std::uint8_t>(filter::kHasVertex | (shaded ? filter::kShaded : 0));

  Rgb u(0, 0, 0), alpha(1, 1, 1);
  float distance = 0;
  for (std::size_t k = first; k <= v; ++k) {
    u += alpha * rows.emission[k];
    if (!rows.distance.empty()) distance += rows.distance[k];
    if (k == v) break;
    u += alpha * (rows.direct[k] + rows.throughput[k] * rows.background[k]);
    alpha *= rows.throughput[k];
  }
  Rgb c(0, 0, 0);  // what vertex k scatters, from the last to x_i
  for (std::size_t k = last; k-- > v;) {
    const Rgb arrives = k + 1 < last ? rows.emission[k + 1] + c : Rgb(0, 0, 0);
    c = rows.direct[k] + rows.throughput[k] * (rows.background[k] + arrives);
  }
  out.unfiltered[i] = u;
  out.throughput[i] = alpha;
  out.contribution[i] = c;
  out.position[i] = rows.position[v];
  const auto take = [&](auto& to, const auto& from) {
    if (!to.empty()) to[i] = from[v];
  };
  take(out.normal, rows.normal);
  take(out.direction, rows.direction);
  take(out.reflectance, rows.reflectance);
  take(out.material, rows.material);
  take(out.roughness, rows.roughness);
  if (!out.distance.empty()) out.distance[i] = distance;
  if (!out.hit_distance.empty()) {
    out.hit_distance[i] =
        v + 1 < last ? rows.distance[v + 1] : std::numeric_limits<float>::infinity();
  }
}

void VertexCut::fail(std::uint64_t row, std::string_view why) const {
  throw Error(
      ErrorCode::bad_input,
      fmt::format("{}: table vertices: record {}: {}; render it again", reader_.path(), row, why));
}

}  // namespace psf::run
