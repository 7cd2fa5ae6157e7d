// The choice of another vertex: what is recorded of all vertices of a path gives x_i, alpha_i, c_i
// and u_i of any of them, and their sum stays the radiance of the path.
#include "run/vertex_cut.h"

#include <fmt/format.h>

#include <functional>
#include <limits>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "formats/layout/metadata.h"
#include "formats/write/writer.h"
#include "run/dump.h"
#include "run/filter_dump.h"
#include "temp_folder.h"

namespace psf {
namespace {

using run::BlockRecords;
using run::Dump;
using run::VertexRule;

constexpr std::size_t kWidth = 40, kHeight = 30, kPass = kWidth * kHeight, kPasses = 3;
constexpr std::size_t kNobody = 99;

struct TestVertex {
  Vec3 position, normal, direction;
  Rgb throughput{0}, emission{0}, direct{0}, background{0}, reflectance{0};
  float distance = 0, roughness = 0;
  std::uint32_t material = 0;
};

struct TestPath {
  std::vector<TestVertex> vertices;
  std::size_t selected = kNobody;
};

std::vector<TestPath> random_paths(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  const auto some = [&] { return uniform(random); };
  const auto triple = [&] { return Vec3(some(), some(), some()); };
  std::vector<TestPath> paths(kPass * kPasses);
  for (TestPath& path : paths) {
    path.vertices.resize(random() % 6);
    for (std::size_t k = 0; k < path.vertices.size(); ++k) {
      TestVertex& v = path.vertices[k];
      v.position = triple();
      v.normal = triple();
      v.direction = triple();
      v.reflectance = triple();
      v.distance = some();
      v.roughness = random() % 3 == 0 ? 0 : some();
      v.material = static_cast<std::uint32_t>(random() % 5);
      if (random() % 3 == 0) v.emission = triple();
      v.direct = triple();
      const bool last = k + 1 == path.vertices.size();
      if (!last || random() % 2 == 0) v.throughput = triple();
      if (last) v.background = triple();
      if (path.selected == kNobody && v.roughness >= 0.3f) path.selected = k;
    }
  }
  return paths;
}

// Forward, term by term: what of the light of the path is emitted by vertex k itself, and what is
// scattered by it first.
struct Light {
  Rgb emitted{0}, direct{0};
};
std::vector<Light> light_of(const TestPath& path) {
  std::vector<Light> light;
  Rgb t(1, 1, 1);
  for (const TestVertex& v : path.vertices) {
    light.push_back({t * v.emission, t * v.direct + t * v.throughput * v.background});
    t *= v.throughput;
  }
  return light;
}

struct CutVertex {
  bool has_vertex = false;
  Rgb u{0}, alpha{0}, alpha_c{0};
};
CutVertex expected_at(const TestPath& path, std::size_t v) {
  CutVertex out;
  const std::vector<Light> light = light_of(path);
  out.has_vertex = v < path.vertices.size();
  for (std::size_t k = 0; k < light.size(); ++k) {
    (k <= v ? out.u : out.alpha_c) += light[k].emitted;
    (k < v ? out.u : out.alpha_c) += light[k].direct;
  }
  if (!out.has_vertex) return out;
  out.alpha = Rgb(1, 1, 1);
  for (std::size_t k = 0; k < v; ++k) out.alpha *= path.vertices[k].throughput;
  return out;
}

template <class Values>
void add_channel(std::vector<formats::Channel>& channels, std::vector<const void*>& columns,
                 const char* name, formats::Type type, std::uint8_t components,
                 const Values& values) {
  channels.push_back({name, type, components, formats::Encoding::plain});
  columns.push_back(values.data());
}

struct Columns {
  std::vector<std::uint32_t> pixel, visibility, path, parent, material, vertex_material;
  std::vector<std::uint8_t> flags, vertex_flags;
  std::vector<Vec3> position, normal, direction, vertex_position, vertex_normal, vertex_direction;
  std::vector<Rgb> throughput, contribution, unfiltered, reflectance, vertex_throughput, emission,
      direct, background, vertex_reflectance;
  std::vector<float> distance, roughness, vertex_distance, vertex_roughness;
};

void add_path(const TestPath& path, std::uint32_t number, Columns& to) {
  const CutVertex at = expected_at(path, path.selected);
  const bool has = at.has_vertex;
  const TestVertex none;
  const TestVertex& x = has ? path.vertices[path.selected] : none;
  float distance = 0;
  for (std::size_t k = 0; has && k <= path.selected; ++k) distance += path.vertices[k].distance;
  Rgb c(0);
  for (int k = 0; has && k < 3; ++k) c[k] = at.alpha[k] > 0 ? at.alpha_c[k] / at.alpha[k] : 0;
  to.pixel.push_back(number);
  to.visibility.push_back(number % 4);
  to.flags.push_back(has ? 3 : 0);
  to.position.push_back(x.position);
  to.normal.push_back(x.normal);
  to.direction.push_back(x.direction);
  to.reflectance.push_back(x.reflectance);
  to.material.push_back(x.material);
  to.roughness.push_back(x.roughness);
  to.distance.push_back(distance);
  to.throughput.push_back(at.alpha);
  to.contribution.push_back(c);
  to.unfiltered.push_back(has ? at.u : at.u + at.alpha_c);
  for (std::size_t k = 0; k < path.vertices.size(); ++k) {
    const TestVertex& v = path.vertices[k];
    to.path.push_back(number);
    to.parent.push_back(k > 0 ? 1 : 0);
    to.vertex_flags.push_back(k == path.selected ? 1 : 0);
    to.vertex_position.push_back(v.position);
    to.vertex_normal.push_back(v.normal);
    to.vertex_direction.push_back(v.direction);
    to.vertex_reflectance.push_back(v.reflectance);
    to.vertex_material.push_back(v.material);
    to.vertex_roughness.push_back(v.roughness);
    to.vertex_distance.push_back(v.distance);
    to.vertex_throughput.push_back(v.throughput);
    to.emission.push_back(v.emission);
    to.direct.push_back(v.direct);
    to.background.push_back(v.background);
  }
}

// `parent`: of vertices that have one. change(columns) makes something else of a pass.
using Change = std::function<void(Columns&)>;
void write_paths(
    const std::string& path, const std::vector<TestPath>& paths, std::uint32_t parent = 1,
    bool with_vertices = true, const Change& change = [](Columns&) {}) {
  using formats::Type;
  formats::Metadata metadata;
  metadata.cameras.resize(1);
  metadata.cameras[0].width = kWidth;
  metadata.cameras[0].height = kHeight;
  metadata.cameras[0].angle_per_pixel = 0.01;
  std::optional<formats::Writer> writer;
  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    Columns c;
    for (std::size_t k = 0; k < kPass; ++k) {
      add_path(paths[pass * kPass + k], static_cast<std::uint32_t>(k), c);
    }
    for (std::uint32_t& p : c.parent) p *= parent;
    change(c);
    formats::Head head;
    head.metadata = formats::to_json(metadata);
    head.chunk_capacity = 500;
    std::vector<const void*> of_paths, of_vertices;
    const auto add = [&](const char* name, Type type, std::uint8_t components, const auto& column) {
      add_channel(head.channels, of_paths, name, type, components, column);
    };
    add("position", Type::f32, 3, c.position);
    add("normal", Type::f32, 3, c.normal);
    add("reflectance", Type::f32, 3, c.reflectance);
    add("throughput", Type::f32, 3, c.throughput);
    add("contribution", Type::f32, 3, c.contribution);
    add("unfiltered", Type::f32, 3, c.unfiltered);
    add("distance", Type::f32, 1, c.distance);
    add("pixel", Type::u32, 1, c.pixel);
    add("flags", Type::u8, 1, c.flags);
    add("visibility", Type::u32, 1, c.visibility);
    add("direction", Type::f32, 3, c.direction);
    add("material", Type::u32, 1, c.material);
    add("roughness", Type::f32, 1, c.roughness);
    add("hit_distance", Type::f32, 1, c.distance);
    formats::Table table;
    table.name = "vertices";
    table.chunk_capacity = 700;
    const auto more = [&](const char* name, Type type, std::uint8_t components,
                          const auto& column) {
      add_channel(table.channels, of_vertices, name, type, components, column);
    };
    more("path", Type::u32, 1, c.path);
    more("parent", Type::u32, 1, c.parent);
    more("flags", Type::u8, 1, c.vertex_flags);
    more("position", Type::f32, 3, c.vertex_position);
    more("normal", Type::f32, 3, c.vertex_normal);
    more("direction", Type::f32, 3, c.vertex_direction);
    more("reflectance", Type::f32, 3, c.vertex_reflectance);
    more("material", Type::u32, 1, c.vertex_material);
    more("roughness", Type::f32, 1, c.vertex_roughness);
    more("distance", Type::f32, 1, c.vertex_distance);
    more("throughput", Type::f32, 3, c.vertex_throughput);
    more("emission", Type::f32, 3, c.emission);
    more("direct", Type::f32, 3, c.direct);
    more("background", Type::f32, 3, c.background);
    if (with_vertices) head.tables.push_back(table);
    if (!writer)
      writer.emplace(path, head, formats::WriterOptions{formats::Codec::zstd, false, {}});
    writer->append(kPass, of_paths);
    if (with_vertices) writer->append_to(1, c.path.size(), of_vertices);
    writer->commit();
  }
  writer->close();
}

std::size_t select_again(const TestPath& path, const VertexRule& rule) {
  double length = 0;
  for (std::size_t k = 0; k < path.vertices.size(); ++k) {
    length += double{path.vertices[k].distance};
    if (rule.kind == VertexRule::Kind::depth && static_cast<double>(k) == rule.value) return k;
    if (rule.kind == VertexRule::Kind::roughness &&
        double{path.vertices[k].roughness} >= rule.value) {
      return k;
    }
    if (rule.kind == VertexRule::Kind::distance && length >= rule.value) return k;
  }
  return kNobody;
}

bool near(const Rgb& a, const Rgb& b) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(a[k] - b[k]) > 2e-5f * (1 + std::abs(b[k]))) return false;
  }
  return true;
}

filter::Parameters with_all_that_vertices_have() {
  filter::Parameters parameters;
  parameters.weights = {0.9f, 0.1f, false, 0.3f, 0.5f, 0.5f, true};
  return parameters;
}

template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("Every rule's text is what it was read from, and others are refused") {
  for (const char* text : {"first-rough", "depth:0", "depth:7", "roughness:0.25", "distance:3.5"}) {
    CHECK(to_text(run::parse_vertex_rule(text)) == text);
  }
  for (const char* text : {"", "rough", "depth", "depth:", "depth:1.5", "depth:-1", "roughness:2",
                           "distance:nan", "depth:1x", "first-rough:1"}) {
    const std::string message = message_of([&] { (void)run::parse_vertex_rule(text); });
    CHECK(message.find("expected first-rough, depth:K") != std::string::npos);
  }
}

TEST_CASE("The vertex of a rule has its x, alpha, c and u, in every range of paths") {
  const tests::TempFolder folder;
  const std::vector<TestPath> paths = random_paths(1);
  const std::string path = folder / "v.pvb";
  write_paths(path, paths);
  for (const char* text : {"depth:0", "depth:2", "roughness:0.7", "roughness:0", "distance:1.2"}) {
    const VertexRule rule = run::parse_vertex_rule(text);
    const Dump dump(path, rule);
    const run::ChannelSet channels = dump.select(with_all_that_vertices_have(), true);
    for (const auto& [first, last] : {std::pair{0u, 3600u}, {1150u, 1260u}, {2399u, 2401u}}) {
      BlockRecords out;
      dump.read({first, last}, channels, out);
      for (std::size_t i = first; i < last; ++i) {
        const std::size_t k = i - first, v = select_again(paths[i], rule);
        const CutVertex at = expected_at(paths[i], v);
        CAPTURE(text, i, v);
        if (((out.flags[k] & filter::kHasVertex) != 0) != at.has_vertex) FAIL("vertex or none");
        const Rgb total = at.u + at.alpha_c;
        if (!near(out.unfiltered[k] + out.throughput[k] * out.contribution[k], total)) {
          FAIL("another radiance");
        }
        if (!at.has_vertex) continue;
        const TestVertex& x = paths[i].vertices[v];
        if (v == paths[i].selected) continue;  // as the file has it
        if (!near(out.unfiltered[k], at.u) || !near(out.throughput[k], at.alpha)) FAIL("u, alpha");
        if (out.flags[k] != 3) FAIL("not shaded");
        const bool same = out.position[k] == x.position && out.normal[k] == x.normal &&
                          out.direction[k] == x.direction && out.material[k] == x.material &&
                          out.roughness[k] == x.roughness && out.reflectance[k] == x.reflectance;
        if (!same) FAIL("of another vertex");
        float distance = 0;
        for (std::size_t n = 0; n <= v; ++n) distance += paths[i].vertices[n].distance;
        if (out.distance[k] != distance) FAIL("another distance");
        const bool goes_on = v + 1 < paths[i].vertices.size();
        const float next =
            goes_on ? paths[i].vertices[v + 1].distance : std::numeric_limits<float>::infinity();
        if (out.hit_distance[k] != next) FAIL("another hit distance");
      }
    }
  }
  SUCCEED("all paths are right");
}

TEST_CASE("The renderer's own vertex changes no bit of the records") {
  const tests::TempFolder folder;
  const std::string path = folder / "v.pvb";
  // Also where it is not among the first vertices, which are all that a table may have.
  const bool is_told = GENERATE(true, false);
  write_paths(path, random_paths(2), 1, true, [&](Columns& c) {
    if (!is_told) c.vertex_flags.assign(c.vertex_flags.size(), 0);
  });
  const Dump plain(path), chosen(path, run::parse_vertex_rule("first-rough"));
  filter::Parameters parameters;
  BlockRecords a, b;
  plain.read({0, 3600}, plain.select(parameters, true), a);
  chosen.read({0, 3600}, chosen.select(parameters, true), b);
  const auto bytes = [](const auto& column) { return std::as_bytes(std::span(column)); };
  CHECK(std::ranges::equal(bytes(a.position), bytes(b.position)));
  CHECK(std::ranges::equal(bytes(a.contribution), bytes(b.contribution)));
  CHECK(std::ranges::equal(bytes(a.throughput), bytes(b.throughput)));
  CHECK(std::ranges::equal(bytes(a.unfiltered), bytes(b.unfiltered)));
  CHECK(a.flags == b.flags);
  CHECK(a.visibility == b.visibility);
  CHECK_FALSE(b.visibility.empty());
}

TEST_CASE("The visibility of another vertex is not known, and so is no term") {
  const tests::TempFolder folder;
  const std::string path = folder / "v.pvb";
  write_paths(path, random_paths(3));
  CHECK(Dump(path).has("visibility"));
  CHECK(Dump(path, run::parse_vertex_rule("first-rough")).has("visibility"));
  const Dump other(path, run::parse_vertex_rule("depth:1"));
  CHECK_FALSE(other.has("visibility"));
  CHECK(other.has("normal"));
  filter::Parameters parameters;
  const std::string message = message_of([&] { (void)other.select(parameters, false); });
  CHECK(message.find("the vertices of depth:1 have no channel visibility, which ") !=
        std::string::npos);
  CHECK(message.find("; choose first-rough, or give ") != std::string::npos);
}

TEST_CASE("Vertices that are not those of the paths in their order are refused, for any range") {
  const tests::TempFolder folder;
  const std::string path = folder / "v.pvb";
  const std::vector<TestPath> paths = random_paths(5);
  // In the first pass: a path with x_i before one without vertices, and two paths with vertices.
  std::uint32_t lonely = 0, pair = 0;
  while (paths[lonely].selected == kNobody || !paths[lonely + 1].vertices.empty()) ++lonely;
  while (paths[pair].vertices.empty() || paths[pair + 1].vertices.empty()) ++pair;
  const auto said = [&](const Change& change) {
    write_paths(path, paths, 1, true, change);
    const Dump dump(path, run::parse_vertex_rule("depth:1"));
    filter::Parameters parameters;
    parameters.weights.switch_off(filter::Term::visibility);
    const run::ChannelSet channels = dump.select(parameters, false);
    return message_of([&] {
      BlockRecords out;
      dump.read({0, kPass}, channels, out);
    });
  };
  const auto exchange = [](Columns& c, std::uint32_t a, std::uint32_t b) {
    for (std::uint32_t& number : c.path) {
      const std::uint32_t was = number;
      if (was == a) number = b;
      if (was == b) number = a;
    }
  };
  CHECK(said([](Columns&) {}).empty());
  CHECK(said([&](Columns& c) { exchange(c, pair, pair + 1); }).find("out of order") !=
        std::string::npos);
  CHECK(said([&](Columns& c) {
          exchange(c, lonely, lonely + 1);
        }).find(fmt::format("v.pvb: record {}: it has a vertex, but its path has none", lonely)) !=
        std::string::npos);
  CHECK(said([](Columns& c) { c.path.back() = kPass; }).find("its path is none of its pass") !=
        std::string::npos);
  CHECK(said([](Columns& c) {
          c.path.back() = 4294967295u;
        }).find("its path is none of its pass") != std::string::npos);
}

TEST_CASE("Without vertices, with paths that split, or with a pass that lost them, it says so") {
  const tests::TempFolder folder;
  const std::string path = folder / "v.pvb";
  const VertexRule rule = run::parse_vertex_rule("depth:1");
  const auto said = [&] {
    return message_of([&] {
      const Dump dump(path, rule);
      filter::Parameters parameters;
      parameters.weights.switch_off(filter::Term::visibility);
      BlockRecords out;
      dump.read({0, 3600}, dump.select(parameters, false), out);
    });
  };
  write_paths(path, random_paths(4), 1, false);
  CHECK(said().find("has no vertices to choose from; render with --vertices all") !=
        std::string::npos);
  write_paths(path, random_paths(4), 2);
  CHECK(said().find("paths that split") != std::string::npos);
  const formats::Head head = formats::Reader(path).head();
  for (const auto& [name, type] : {std::pair("path", formats::Type::u64),
                                   {"parent", formats::Type::u16},
                                   {"flags", formats::Type::u32},
                                   {"direct", formats::Type::u32}}) {
    formats::Head other = head;
    other.tables[0].channels[*other.tables[0].find(name)].type = type;
    const std::string copy = folder / "other.pvb";
    {
      formats::Writer writer(copy, other, {formats::Codec::raw, false, {}});
      const std::vector<std::byte> zeros(64 * 16);
      const std::vector<const void*> columns(20, zeros.data());
      writer.append(1, std::span(columns).first(other.channels.size()));
      writer.append_to(1, 1, std::span(columns).first(other.tables[0].channels.size()));
      writer.commit();
    }
    const std::string message = message_of([&] { (void)Dump(copy, rule); });
    CHECK(message.find(std::string("table vertices: channel ") + name + " is ") !=
          std::string::npos);
  }
  std::vector<TestPath> none = random_paths(4);
  for (std::size_t k = kPass; k < 2 * kPass; ++k) none[k] = {};
  write_paths(path, none);
  CHECK(said().find("pass 1 has no vertices") != std::string::npos);
}

}  // namespace psf
