// Pixels: which a path belongs to, how many paths it gets, and what their sum is.
#include <cmath>

#include "catch.h"
#include "formats/layout/metadata.h"
#include "render_dump.h"

using namespace psf;
using namespace psf::tests;

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
    std::vector<int> tile(6 * 4, 0);  // tiles of 16 x 16 pixels, with about 256 paths each
    for (std::size_t i = pass * kLeft; i < (pass + 1) * kLeft; ++i) {
      ++tile[pixel[i] % 96 / 16 + 6 * (pixel[i] / 96 / 16)];
    }
    for (const int c : tile) CHECK(std::abs(c - 256) <= 8);
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
    std::size_t without_vertex = 0;
    for (std::size_t i = 0; i < flags.size(); ++i) {
      without_vertex += (flags[i] & 1) == 0 ? 1u : 0u;
      if ((flags[i] & 2) != 0) {
        ++shaded[i % kLeft];
        ++in_row[i / 48];
      } else {
        CHECK(contribution[i] == Rgb(0, 0, 0));
      }
    }
    // What a path meets plays no part: those without vertex have the flag as well.
    CHECK(without_vertex > kLeft / 8);
    for (const std::uint32_t count : in_row) CHECK(count == 48 / k);
    for (const std::uint32_t count : shaded) CHECK(count == 1);
  }
}

TEST_CASE("the picture with a shade rate is the mean of the paths that are shaded, or would be") {
  RenderSettings settings = quiet_settings(6);
  settings.shade_rate = 4;
  const TempFolder folder;
  const RenderResult result = render_to(folder / "a.pvb", settings);
  const Columns columns = read_all(folder / "a.pvb");
  const auto pixel = values<std::uint32_t>(columns, "pixel");
  const auto flags = values<std::uint8_t>(columns, "flags");
  const auto u = values<Rgb>(columns, "unfiltered");
  const auto alpha = values<Rgb>(columns, "throughput");
  const auto c = values<Rgb>(columns, "contribution");
  std::vector<double> sum(kLeft, 0), count(kLeft, 0);
  for (std::size_t i = 0; i < pixel.size(); ++i) {
    if ((flags[i] & 2) == 0) continue;
    ++count[pixel[i]];
    sum[pixel[i]] += double{u[i].y} + double{alpha[i].y} * double{c[i].y};
  }
  const auto mean = result.films[0].mean();
  for (std::size_t k = 0; k < kLeft; ++k) {
    CHECK(count[k] > 0);
    CHECK(double{mean[3 * k + 1]} == Approx(sum[k] / count[k]).margin(1e-6));
  }
  const formats::Reader reader(folder / "a.pvb");
  CHECK(formats::parse_metadata(reader.head().metadata).shade_rate == 4);
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
