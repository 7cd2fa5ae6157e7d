// The loop over passes, cameras and paths, seen through the dumps that it writes.
#include "render/render.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "catch.h"
#include "core/parallel.h"
#include "fake_integrator.h"
#include "formats/error.h"
#include "formats/metadata.h"
#include "formats/reader.h"
#include "render/camera.h"
#include "temp_folder.h"

using namespace psf;
using namespace psf::render;
using psf::tests::FakeIntegrator;
using psf::tests::TempFolder;

namespace {

using Columns = std::map<std::string, std::vector<std::byte>>;

RenderSettings quiet_settings(std::uint64_t passes) {
  RenderSettings settings;
  settings.passes = passes;
  settings.cameras = {0};
  settings.quiet = true;
  return settings;
}

RenderResult render_to(const std::string& path, const RenderSettings& settings,
                       formats::Codec codec = formats::Codec::raw) {
  const Scene scene = tests::two_camera_scene();
  const FakeIntegrator integrator;
  formats::WriterOptions options;
  options.codec = codec;
  options.sync = false;
  formats::Writer writer(path, make_head(scene, integrator, settings), options);
  return render::render(scene, integrator, settings, &writer);
}

Columns read_all(const std::string& path) {
  const formats::Reader reader(path);
  Columns columns;
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    const formats::Channel& channel = reader.head().channels[k];
    std::vector<std::byte> bytes(reader.records() * channel.stride());
    reader.read(k, 0, reader.records(), bytes);
    columns[channel.name] = std::move(bytes);
  }
  return columns;
}

template <class T>
std::vector<T> values(const Columns& columns, const std::string& channel) {
  const auto& bytes = columns.at(channel);
  std::vector<T> result(bytes.size() / sizeof(T));
  std::memcpy(static_cast<void*>(result.data()), bytes.data(), bytes.size());
  return result;
}

Columns columns_of(const RenderSettings& settings, std::size_t threads = 0) {
  const TempFolder folder;
  const core::ThreadLimit limit(threads);
  (void)render_to(folder / "a.pvb", settings);
  return read_all(folder / "a.pvb");
}

constexpr std::size_t kLeft = 96 * 64;
constexpr std::size_t kRight = 50 * 40;

}  // namespace

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

TEST_CASE("the position of a record lies in its pixel, by the matrices of the file") {
  for (const Enumeration enumeration : {Enumeration::pixel, Enumeration::global}) {
    RenderSettings settings = quiet_settings(2);
    settings.sampler.enumeration = enumeration;
    const TempFolder folder;
    (void)render_to(folder / "a.pvb", settings);
    const formats::Reader reader(folder / "a.pvb");
    const auto metadata = formats::parse_metadata(reader.head().metadata);
    const auto& projection = metadata.cameras.at(0).projection;
    const Columns columns = read_all(folder / "a.pvb");
    const auto position = values<Vec3>(columns, "position");
    const auto pixel = values<std::uint32_t>(columns, "pixel");
    const auto flags = values<std::uint8_t>(columns, "flags");
    std::size_t seen = 0;
    for (std::size_t i = 0; i < pixel.size(); ++i) {
      if ((flags[i] & 1) == 0) continue;
      ++seen;  // the camera stands at the origin and looks along -z: camera space is world space
      const Vec3 p = position[i];
      const double x = (projection[0] * double{p.x} / -double{p.z} + 1) / 2 * 96;
      const double y = (1 - projection[5] * double{p.y} / -double{p.z}) / 2 * 64;
      if (std::abs(x - (pixel[i] % 96 + 0.5)) > 0.501 ||
          std::abs(y - (pixel[i] / 96 + 0.5)) > 0.501) {
        FAIL("record " << i << " of pixel " << pixel[i] << " lies at " << x << ", " << y);
      }
    }
    CHECK(seen > kLeft);
  }
}

TEST_CASE("global enumeration gives every pixel its share, evenly in every pass") {
  RenderSettings settings = quiet_settings(16);
  settings.sampler.enumeration = Enumeration::global;
  const auto pixel = values<std::uint32_t>(columns_of(settings), "pixel");
  REQUIRE(pixel.size() == 16 * kLeft);
  std::vector<int> count(kLeft, 0);
  for (const std::uint32_t p : pixel) ++count.at(p);
  // Independent points would leave pixels of 3 and of 30; these stay near 16.
  for (const int c : count) CHECK(std::abs(c - 16) <= 4);
  for (std::size_t pass = 0; pass < 16; ++pass) {
    std::vector<int> tile(6 * 4, 0);  // of 16 x 16 pixels, 256 paths each
    for (std::size_t i = pass * kLeft; i < (pass + 1) * kLeft; ++i) {
      ++tile[pixel[i] % 96 / 16 + 6 * (pixel[i] / 96 / 16)];
    }
    for (const int c : tile) CHECK(std::abs(c - 256) <= 8);
  }
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

TEST_CASE("the picture is the mean of u + alpha c of the dump") {
  RenderSettings settings = quiet_settings(5);
  settings.sampler.enumeration = Enumeration::global;
  const TempFolder folder;
  const RenderResult result = render_to(folder / "a.pvb", settings);
  const Columns columns = read_all(folder / "a.pvb");
  const auto pixel = values<std::uint32_t>(columns, "pixel");
  const auto u = values<Rgb>(columns, "unfiltered");
  const auto alpha = values<Rgb>(columns, "throughput");
  const auto c = values<Rgb>(columns, "contribution");
  std::vector<double> sum(3 * kLeft, 0);
  std::vector<double> count(kLeft, 0);
  for (std::size_t i = 0; i < pixel.size(); ++i) {
    ++count[pixel[i]];
    for (int k = 0; k < 3; ++k) {
      sum[3 * pixel[i] + static_cast<std::size_t>(k)] +=
          double{u[i][k]} + double{alpha[i][k]} * double{c[i][k]};
    }
  }
  const auto mean = result.films[0].mean();
  for (std::size_t k = 0; k < mean.size(); ++k) {
    CHECK(double{mean[k]} == Approx(count[k / 3] == 0 ? 0 : sum[k] / count[k / 3]).margin(1e-6));
  }
}

TEST_CASE("one path in K is shaded: exactly so over K passes, and in every row of K pixels") {
  for (const std::uint32_t k : {2u, 3u, 4u, 16u}) {
    RenderSettings settings = quiet_settings(k);
    settings.shade_rate = k;
    const Columns columns = columns_of(settings);
    const auto flags = values<std::uint8_t>(columns, "flags");
    const auto contribution = values<Rgb>(columns, "contribution");
    std::vector<std::uint32_t> shaded(kLeft, 0);
    std::vector<std::uint32_t> in_row(kLeft * k / 48, 0);
    std::vector<bool> whole_row(in_row.size(), true);
    for (std::size_t i = 0; i < flags.size(); ++i) {
      if ((flags[i] & 1) == 0) {
        whole_row[i / 48] = false;
        continue;
      }
      if ((flags[i] & 2) != 0) {
        ++shaded[i % kLeft];
        ++in_row[i / 48];
      } else {
        CHECK(contribution[i] == Rgb(0, 0, 0));
      }
    }
    for (std::size_t row = 0; row < in_row.size(); ++row) {
      if (whole_row[row]) CHECK(in_row[row] == 48 / k);
    }
    for (std::size_t pixel = 0; pixel < kLeft; ++pixel) {
      if (pixel % 96 >= 48) CHECK(shaded[pixel] == 1);  // the right half has vertices everywhere
    }
  }
}

TEST_CASE("pictures with a shade rate keep their mean") {
  RenderSettings settings = quiet_settings(8);
  const TempFolder folder;
  const auto mean_of = [](const film::Film& film) {
    double sum = 0;
    const auto mean = film.mean();
    for (const float value : mean) sum += double{value};
    return sum / static_cast<double>(mean.size());
  };
  const double all = mean_of(render_to(folder / "a.pvb", settings).films[0]);
  settings.shade_rate = 4;
  CHECK(mean_of(render_to(folder / "b.pvb", settings).films[0]) == Approx(all).epsilon(0.01));
}

TEST_CASE("several cameras share a pass, each with its own picture") {
  RenderSettings settings = quiet_settings(2);
  settings.cameras = {};
  const TempFolder folder;
  const RenderResult result = render_to(folder / "a.pvb", settings);
  CHECK(result.films.size() == 2);
  CHECK(result.films[1].width() == 50);
  const Columns columns = read_all(folder / "a.pvb");
  const auto camera = values<std::uint16_t>(columns, "camera");
  const auto pixel = values<std::uint32_t>(columns, "pixel");
  REQUIRE(camera.size() == 2 * (kLeft + kRight));
  for (std::size_t i = 0; i < camera.size(); ++i) {
    const std::size_t in_pass = i % (kLeft + kRight);
    CHECK(camera[i] == (in_pass < kLeft ? 0 : 1));
    CHECK(pixel[i] == (in_pass < kLeft ? in_pass : in_pass - kLeft));
  }
  // One camera alone is renumbered and is the only one the file names.
  settings.cameras = {1};
  (void)render_to(folder / "b.pvb", settings);
  const formats::Reader reader(folder / "b.pvb");
  const auto metadata = formats::parse_metadata(reader.head().metadata);
  REQUIRE(metadata.cameras.size() == 1);
  CHECK(metadata.cameras[0].name == "right");
  CHECK(values<std::uint16_t>(read_all(folder / "b.pvb"), "camera")[0] == 0);
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
