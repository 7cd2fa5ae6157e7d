// The loop over passes, cameras and paths, seen through the dumps that it writes.
#include "render/loop/render.h"

#include <algorithm>

#include "catch.h"
#include "core/error.h"
#include "formats/layout/metadata.h"
#include "render/camera/camera.h"
#include "render_dump.h"

using namespace psf;
using namespace psf::tests;

TEST_CASE("the same columns and pictures for any number of threads and either codec") {
  for (const Enumeration enumeration : {Enumeration::pixel, Enumeration::global}) {
    RenderSettings settings = quiet_settings(3);
    settings.sampler.enumeration = enumeration;
    const Columns one = columns_of(settings, 1);
    CHECK(one == columns_of(settings, 2));
    CHECK(one == columns_of(settings, 7));
    const TempFolder folder;
    const RenderResult result = render_to(folder / "z.pvb", settings, formats::Codec::zstd);
    CHECK(one == read_all(folder / "z.pvb"));
    const core::ThreadLimit limit(1);
    CHECK(render_to(folder / "y.pvb", settings).films[0].mean() == result.films[0].mean());
  }
}

TEST_CASE("another seed or sampler gives another dump") {
  const RenderSettings settings = quiet_settings(1);
  RenderSettings seeded = settings;
  seeded.sampler.seed = 1;
  RenderSettings halton = settings;
  halton.sampler.kind = SamplerKind::halton;
  const Columns columns = columns_of(settings);
  CHECK(columns.at("position") != columns_of(seeded).at("position"));
  CHECK(columns.at("position") != columns_of(halton).at("position"));
}

TEST_CASE("the passes of a short run are the first of a long one") {
  for (const Enumeration enumeration : {Enumeration::pixel, Enumeration::global}) {
    RenderSettings settings = quiet_settings(2);
    settings.sampler.enumeration = enumeration;
    const Columns few = columns_of(settings);
    settings.passes = 4;
    Columns many = columns_of(settings);
    for (auto& [channel, bytes] : many) {
      bytes.resize(bytes.size() / 2);
      CHECK(bytes == few.at(channel));
    }
  }
}

TEST_CASE("a record a path, a commit a pass, in scanline order") {
  const TempFolder folder;
  const RenderResult result = render_to(folder / "a.pvb", quiet_settings(3));
  CHECK(result.paths == 3 * kLeft);
  CHECK(result.rays == 9 * kLeft);
  CHECK(result.passes == 3);
  CHECK_FALSE(result.interrupted);
  const formats::Reader reader(folder / "a.pvb");
  CHECK(reader.closed());
  CHECK(reader.records() == 3 * kLeft);
  REQUIRE(reader.passes().size() == 3);
  CHECK(reader.passes()[2].first == 2 * kLeft);
  const auto pixel = values<std::uint32_t>(read_all(folder / "a.pvb"), "pixel");
  for (std::size_t i = 0; i < pixel.size(); ++i) CHECK(pixel[i] == i % kLeft);
}

TEST_CASE("contiguous paths, across passes and cameras, are stratified where they should be") {
  // The integrator stores the sampler's third number as u's red.
  const auto is_stratified = [](const std::vector<float>& numbers) {
    std::vector<int> count(numbers.size(), 0);
    for (const float u : numbers) {
      ++count[static_cast<std::size_t>(double{u} * static_cast<double>(numbers.size()))];
    }
    return std::all_of(count.begin(), count.end(), [](int k) { return k == 1; });
  };
  RenderSettings settings = quiet_settings(16);
  settings.cameras = {};
  const auto per_pixel = values<Rgb>(columns_of(settings), "unfiltered");
  for (std::size_t path = 0; path < kLeft + kRight; ++path) {
    std::vector<float> passes;
    for (std::size_t pass = 0; pass < 16; ++pass) {
      passes.push_back(per_pixel[pass * (kLeft + kRight) + path].x);
    }
    CHECK(is_stratified(passes));
  }
  // Cameras do not repeat each other's numbers.
  std::size_t equal = 0;
  for (std::size_t k = 0; k < kRight; ++k) equal += per_pixel[k].x == per_pixel[kLeft + k].x;
  CHECK(equal < 3);

  settings.sampler.enumeration = Enumeration::global;
  const auto global = values<Rgb>(columns_of(settings), "unfiltered");
  for (std::size_t block = 0; block + 256 <= global.size(); block += 256) {
    std::vector<float> numbers;
    for (std::size_t i = block; i < block + 256; ++i) numbers.push_back(global[i].x);
    CHECK(is_stratified(numbers));
  }
}

TEST_CASE("the file says how it was made") {
  RenderSettings settings = quiet_settings(1);
  settings.sampler = {SamplerKind::halton, Enumeration::global, 99};
  settings.integrator.split = 3;
  settings.integrator.vertex_roughness = 0.25f;
  settings.producer = "test 1";
  const Scene scene = tests::two_camera_scene();
  const auto head = make_head(scene, FakeIntegrator(), settings);
  const auto metadata = formats::parse_metadata(head.metadata);
  CHECK(metadata.producer == "test 1");
  CHECK(metadata.scene == "fake.json");
  CHECK(metadata.scene_hash == "0123abcd");
  CHECK(metadata.integrator == "path");
  CHECK(metadata.sampler == "halton");
  CHECK(metadata.enumeration == "global");
  CHECK(metadata.seed == 99);
  CHECK(metadata.split == 3);
  CHECK(metadata.vertex_roughness == 0.25);
  CHECK(metadata.vertex_rule.find("0.25") != std::string::npos);
  CHECK(metadata.lights == std::vector<std::string>{"lamp", "sun"});
  CHECK(metadata.cameras == std::vector{CameraRays(scene.cameras[0]).info()});
}

TEST_CASE("the file names the materials by their number, as many as the metadata hold") {
  Scene scene = tests::two_camera_scene();
  scene.materials.resize(3);
  scene.materials[0].name = "wall";
  scene.materials[2].name = "caf\xE9";  // Latin-1
  const auto names = [&] {
    const auto head = make_head(scene, FakeIntegrator(), quiet_settings(1));
    formats::validate(head);  // refuses metadata that are too long
    return formats::parse_metadata(head.metadata).materials;
  };
  CHECK(names() == std::vector<std::string>{"wall", "", "caf\xEF\xBF\xBD"});
  scene.materials.resize(20000);
  for (std::size_t k = 3; k < scene.materials.size(); ++k) {
    scene.materials[k].name = std::to_string(k) + std::string(100, 'x');
  }
  const auto some = names();
  REQUIRE(some.size() >= 5000);
  REQUIRE(some.size() < 20000);
  CHECK(some[0] == "wall");
  CHECK(some[4999] == scene.materials[4999].name);
}

TEST_CASE("a pass larger than a slab is written whole") {
  Scene scene = tests::two_camera_scene();
  scene.cameras[0].width = 700;
  scene.cameras[0].height = 601;  // 420,700 paths: two slabs, the second not full
  const TempFolder folder;
  const RenderSettings settings = quiet_settings(2);
  const FakeIntegrator integrator;
  formats::WriterOptions options;
  options.sync = false;
  formats::Writer writer(folder / "a.pvb", make_head(scene, integrator, settings), options);
  (void)render::render(scene, integrator, settings, &writer);
  const auto pixel = values<std::uint32_t>(read_all(folder / "a.pvb"), "pixel");
  REQUIRE(pixel.size() == 841400);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < pixel.size(); ++i) wrong += pixel[i] != i % 420700;
  CHECK(wrong == 0);
}

TEST_CASE("a time limit ends after the pass that reaches it, with a closed file") {
  RenderSettings settings = quiet_settings(1000000);
  settings.time_limit = 0.05;
  const TempFolder folder;
  const RenderResult result = render_to(folder / "a.pvb", settings);
  CHECK(result.passes < 1000000);
  const formats::Reader reader(folder / "a.pvb");
  CHECK(reader.closed());
  CHECK(reader.records() == result.passes * kLeft);
}

TEST_CASE("settings out of range are refused") {
  const Scene scene = tests::two_camera_scene();
  const auto code = [&](const auto& change) {
    RenderSettings settings = quiet_settings(1);
    change(settings);
    try {
      settings.validate(scene);
    } catch (const Error& error) {
      return static_cast<int>(error.code());
    }
    return 0;
  };
  CHECK(code([](RenderSettings&) {}) == 0);
  CHECK(code([](RenderSettings& s) { s.passes = 0; }) == 2);
  CHECK(code([](RenderSettings& s) { s.shade_rate = 0; }) == 2);
  CHECK(code([](RenderSettings& s) { s.shade_rate = 70000; }) == 2);
  CHECK(code([](RenderSettings& s) { s.passes = std::uint64_t{1} << 36; }) == 5);
}
