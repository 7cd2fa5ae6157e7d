// The tables `vertices` and `photons` of a dump: the light of a path is what its vertices have, no
// path changes for being told, and photons carry the power of the lights.
#include "render/loop/vertex_table.h"

#include "core/error.h"
#include "light_path_scenes.h"
#include "render/loop/photon_table.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

Camera looking(std::uint32_t width, std::uint32_t height, const Vec3& eye, const Vec3& target) {
  Camera camera;
  camera.name = "main";
  camera.width = width;
  camera.height = height;
  camera.eye = eye;
  camera.target = target;
  return camera;
}

Scene room() {
  Scene scene = full_room();
  scene.cameras = {looking(24, 18, {0, 0, 0.9f}, {0, -0.2f, -1})};
  return scene;
}

Scene outdoors() {
  Scene scene = open_scene();
  scene.cameras = {looking(24, 18, {0, 0.6f, 2}, {0, 0.3f, 0})};
  return scene;
}

RenderSettings told(std::uint32_t vertices, std::uint32_t photons,
                    const char* integrator = "path") {
  RenderSettings settings;
  settings.passes = 2;
  settings.quiet = true;
  settings.integrator.name = integrator;
  settings.integrator.vertices = vertices;
  settings.integrator.photons = photons;
  return settings;
}

void write(const std::string& path, const Scene& scene, const RenderSettings& settings) {
  const auto integrator = make_integrator(scene, settings.integrator);
  formats::WriterOptions options;
  options.sync = false;
  formats::Writer writer(path, make_head(scene, *integrator, settings), options);
  static_cast<void>(render::render(scene, *integrator, settings, &writer));
}

template <class T>
std::vector<T> column(const formats::TableReader& table, const char* name) {
  const std::size_t k = table.require(name, "the test");
  std::vector<T> values(table.records() * table.schema().channels[k].stride() / sizeof(T));
  table.read(k, 0, table.records(), std::as_writable_bytes(std::span(values)));
  return values;
}

// The largest relative difference between the radiance of a path and what its vertices add up to.
double worst_sum(const formats::Reader& reader) {
  const formats::TableReader &paths = reader.table(0), &vertices = reader.table(1);
  const auto u = column<Rgb>(paths, "unfiltered"), alpha = column<Rgb>(paths, "throughput"),
             c = column<Rgb>(paths, "contribution");
  const auto path = column<std::uint32_t>(vertices, "path"),
             parent = column<std::uint32_t>(vertices, "parent");
  const auto throughput = column<Rgb>(vertices, "throughput"),
             emission = column<Rgb>(vertices, "emission"), direct = column<Rgb>(vertices, "direct"),
             background = column<Rgb>(vertices, "background");
  std::vector<Imath::V3d> sums(paths.records(), Imath::V3d(0));
  std::vector<bool> has(paths.records());
  for (std::size_t pass = 0; pass < reader.passes().size(); ++pass) {
    const formats::Pass& rows = vertices.passes()[pass];
    Imath::V3d t(1);
    for (std::size_t k = rows.first; k < rows.first + rows.count; ++k) {
      t = parent[k] == 0 ? Imath::V3d(1) : t * Imath::V3d(throughput[k - 1]);
      const std::size_t i = reader.passes()[pass].first + path[k];
      has[i] = true;
      sums[i] += t * (Imath::V3d(emission[k]) + Imath::V3d(direct[k]) +
                      Imath::V3d(throughput[k]) * Imath::V3d(background[k]));
    }
  }
  double worst = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (!has[i]) continue;
    const Imath::V3d radiance = Imath::V3d(u[i]) + Imath::V3d(alpha[i]) * Imath::V3d(c[i]);
    for (int k = 0; k < 3; ++k) {
      worst = std::max(worst, std::abs(radiance[k] - sums[i][k]) / (std::abs(radiance[k]) + 1e-3));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("The light of a path is what its vertices have, all of them or the first") {
  const psf::tests::TempFolder folder;
  const std::string path = folder / "v.pvb";
  for (const bool indoors : {true, false}) {
    const Scene scene = indoors ? room() : outdoors();
    for (const char* integrator : {"path", "direct"}) {
      for (const std::uint32_t most : {1u, 2u, 3u, 65535u}) {
        write(path, scene, told(most, 0, integrator));
        const formats::Reader reader(path);
        CAPTURE(indoors, integrator, most);
        CHECK(reader.table(1).records() > reader.records() / 2);
        CHECK(worst_sum(reader) < 1e-5);
        for (const std::uint16_t depth : column<std::uint16_t>(reader.table(1), "depth")) {
          if (depth >= most) FAIL("more vertices than were asked for");
        }
      }
    }
  }
}

TEST_CASE("Whoever is told of the vertices and photons gets the same paths") {
  const psf::tests::TempFolder folder;
  const std::string plain = folder / "plain.pvb", with = folder / "with.pvb";
  const Scene scene = room();
  write(plain, scene, told(0, 0));
  write(with, scene, told(65535, 100));
  CHECK(psf::tests::read_all(plain) == psf::tests::read_all(with));
  CHECK(formats::Reader(plain).head().tables.empty());
  CHECK(formats::Reader(with).head().tables.size() == 2);
}

TEST_CASE("x_i is marked among the vertices, and is what the record says") {
  const psf::tests::TempFolder folder;
  const std::string path = folder / "v.pvb";
  write(path, room(), told(65535, 0));
  const formats::Reader reader(path);
  const formats::TableReader &paths = reader.table(0), &vertices = reader.table(1);
  const auto flags = column<std::uint8_t>(paths, "flags"),
             marks = column<std::uint8_t>(vertices, "flags"),
             lobes = column<std::uint8_t>(vertices, "lobe");
  const auto x = column<Vec3>(paths, "position"), n = column<Vec3>(paths, "normal"),
             at = column<Vec3>(vertices, "position"), normal = column<Vec3>(vertices, "normal");
  const auto rho = column<Rgb>(paths, "reflectance"), albedo = column<Rgb>(vertices, "reflectance");
  const auto number = column<std::uint32_t>(vertices, "path");
  const auto way = column<float>(paths, "distance"), segment = column<float>(vertices, "distance"),
             pdf = column<float>(vertices, "pdf");
  std::size_t marked = 0;
  for (std::size_t pass = 0; pass < 2; ++pass) {
    const formats::Pass& rows = vertices.passes()[pass];
    float length = 0;
    for (std::size_t k = rows.first; k < rows.first + rows.count; ++k) {
      length = k > rows.first && number[k] == number[k - 1] ? length + segment[k] : segment[k];
      if ((lobes[k] & 3) == 3 && !std::isinf(pdf[k])) FAIL("a perfect lobe without its density");
      if (lobes[k] == 0 && pdf[k] != 0) FAIL("an end with a density");
      if (marks[k] != 1) continue;
      ++marked;
      const std::size_t i = reader.passes()[pass].first + number[k];
      if (flags[i] != 3) FAIL("marked, but the record has no vertex");
      if (at[k] != x[i] || normal[k] != n[i] || albedo[k] != rho[i]) FAIL("another vertex");
      if (std::abs(length - way[i]) > 1e-5f * way[i]) FAIL("another distance");
    }
  }
  CHECK(marked == static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 3)));
  // Glass is passed, and seen through.
  CHECK(std::count(lobes.begin(), lobes.end(), 3 + 8) > 10);
  CHECK(std::count(lobes.begin(), lobes.end(), 1) > 100);
}

TEST_CASE("Tables are the same for any number of threads, and for a render that was stopped") {
  const psf::tests::TempFolder folder;
  const Scene scene = room();
  const auto bytes = [&](const std::string& path) {
    std::vector<std::vector<std::byte>> all;
    const formats::Reader reader(path);
    for (std::size_t t = 0; t < 3; ++t) {
      const formats::TableReader& table = reader.table(t);
      for (std::size_t k = 0; k < table.schema().channels.size(); ++k) {
        all.emplace_back(table.records() * table.schema().channels[k].stride());
        table.read(k, 0, table.records(), all.back());
      }
    }
    return all;
  };
  const std::string whole = folder / "whole.pvb", one = folder / "one.pvb",
                    stopped = folder / "stopped.pvb";
  const RenderSettings settings = told(65535, 700);
  write(whole, scene, settings);
  {
    const core::ThreadLimit limit(1);
    write(one, scene, settings);
  }
  CHECK(bytes(whole) == bytes(one));
  RenderSettings first = settings;
  first.passes = 1;
  write(stopped, scene, first);
  const auto integrator = make_integrator(scene, settings.integrator);
  formats::WriterOptions options;
  options.sync = false;
  {
    formats::Writer writer =
        formats::Writer::resume(stopped, make_head(scene, *integrator, settings), options);
    static_cast<void>(render::render(scene, *integrator, settings, &writer));
  }
  CHECK(bytes(whole) == bytes(stopped));
  RenderSettings other = settings;
  other.passes = 3;
  other.integrator.vertices = 2;
  formats::Writer writer =
      formats::Writer::resume(stopped, make_head(scene, *integrator, other), options);
  CHECK_THROWS_AS(render::render(scene, *integrator, other, &writer), Error);
}

TEST_CASE("Photons that come straight carry the power of the lamp, in the unit of the world") {
  // A lamp of area 0.64 and radiance 6 sends 6 pi 0.64 into a closed room.
  const psf::tests::TempFolder folder;
  const std::string path = folder / "p.pvb";
  constexpr std::uint32_t kPaths = 70000;  // more than are traced at once
  write(path, room(), told(0, kPaths));
  const formats::Reader reader(path);
  const formats::TableReader& photons = reader.table(1);
  CHECK(photons.name() == "photons");
  const auto power = column<Rgb>(photons, "power");
  const auto depth = column<std::uint16_t>(photons, "depth");
  const auto light = column<std::uint32_t>(photons, "light");
  const auto number = column<std::uint32_t>(photons, "path");
  const auto normal = column<Vec3>(photons, "normal"), toward = column<Vec3>(photons, "direction");
  for (const formats::Pass& pass : photons.passes()) {
    const auto first = number.begin() + static_cast<std::ptrdiff_t>(pass.first);
    const auto last = first + static_cast<std::ptrdiff_t>(pass.count);
    CHECK(std::is_sorted(first, last));
    CHECK(*first == 0);
    CHECK(*(last - 1) == kPaths - 1);
  }
  double straight = 0;
  for (std::size_t k = 0; k < power.size(); ++k) {
    if (light[k] != 0) FAIL("of no light");
    if (dot(normal[k], toward[k]) < -1e-4f) FAIL("on the side away from the light");
    if (depth[k] == 0) straight += double{power[k].y} / 2;  // passes
  }
  CHECK(straight == Approx(6 * 3.14159265 * 0.64).epsilon(1e-4));
}

TEST_CASE("Integrators whose paths are no chains of vertices, or know no light, say so") {
  const Scene scene = room();
  const auto said = [&](RenderSettings settings) {
    try {
      static_cast<void>(make_integrator(scene, settings.integrator));
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::usage);
      return std::string(error.what());
    }
    return std::string();
  };
  for (const char* name : {"vpl", "photon", "ao"}) {
    CHECK(said(told(1, 0, name)).find("`vertices`") != std::string::npos);
  }
  RenderSettings split = told(5, 0);
  split.integrator.split = 2;
  CHECK(said(split).find("without `split`") != std::string::npos);
  CHECK(said(told(0, 10, "ao")).find("`photons`") != std::string::npos);
  CHECK(said(told(0, 10, "vpl")).empty());
}

TEST_CASE("More light paths than their numbers hold are refused, those of the table too") {
  const Scene scene = room();
  RenderSettings settings = told(0, 1u << 27);
  settings.passes = 1u << 13;
  for (const char* name : {"path", "photon", "vpl"}) {
    settings.integrator.name = name;
    try {
      settings.validate(scene);
      FAIL("no error for " << name);
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::limit);
      CHECK(std::string(error.what()).find("lower the passes or the light paths") !=
            std::string::npos);
    }
  }
  --settings.passes;
  settings.validate(scene);
}
