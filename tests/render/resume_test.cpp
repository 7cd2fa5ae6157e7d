// A render that was stopped and goes on is the render that never stopped.
#include "render/loop/resume.h"

#include <csignal>
#include <cstring>
#include <filesystem>

#include "catch.h"
#include "core/error.h"
#include "render_dump.h"

using namespace psf;
using namespace psf::tests;

namespace {

formats::WriterOptions fast() {
  formats::WriterOptions options;
  options.sync = false;
  return options;
}

RenderResult resume(const std::string& path, const RenderSettings& settings) {
  const Scene scene = two_camera_scene();
  const FakeIntegrator integrator;
  formats::Writer writer =
      formats::Writer::resume(path, make_head(scene, integrator, settings), fast());
  return render::render(scene, integrator, settings, &writer);
}

RenderSettings with(RenderSettings settings, std::uint64_t passes) {
  settings.passes = passes;
  return settings;
}

// Appends records behind the last commit, as a killed renderer leaves them.
void add_tail(const std::string& path, const RenderSettings& settings) {
  const std::string copy = path + ".copy";
  std::filesystem::copy_file(path, copy);
  {
    const Scene scene = two_camera_scene();
    const FakeIntegrator integrator;
    formats::Head head = make_head(scene, integrator, settings);
    formats::Writer writer = formats::Writer::resume(copy, head, fast());
    RenderSettings more = settings;
    more.passes = writer.passes() + 1;
    (void)render::render(scene, integrator, more, &writer);
  }
  // Without the commits that came then.
  const auto size = std::filesystem::file_size(copy);
  std::filesystem::resize_file(copy, size - 3 * 4096 - 17);
  std::filesystem::rename(copy, path);
}

std::string refusal(const std::string& path, const RenderSettings& settings) {
  try {
    (void)resume(path, settings);
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::bad_input);
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a render that goes on gives the same columns and pictures") {
  const TempFolder folder;
  RenderSettings plain = quiet_settings(7);
  RenderSettings global = plain;
  global.cameras = {0, 1};
  global.sampler.enumeration = Enumeration::global;
  RenderSettings halton = global;
  halton.sampler.kind = SamplerKind::halton;
  halton.shade_rate = 4;
  for (const RenderSettings& settings : {plain, global, halton}) {
    const std::string whole = folder / "whole.pvb", parts = folder / "parts.pvb";
    std::filesystem::remove(whole);
    std::filesystem::remove(parts);
    const RenderResult expected = render_to(whole, settings, formats::Codec::zstd);
    (void)render_to(parts, with(settings, 2), formats::Codec::zstd);
    (void)resume(parts, with(settings, 3));
    add_tail(parts, settings);
    CHECK(formats::Reader(parts).uncommitted_bytes() > 0);
    const RenderResult result = resume(parts, settings);
    CHECK(read_all(parts) == read_all(whole));
    CHECK(formats::Reader(parts).closed());
    CHECK(result.passes == 7);
    CHECK(result.paths == expected.paths);
    CHECK(result.rays == expected.rays);
    CHECK(result.non_finite == expected.non_finite);
    REQUIRE(result.films.size() == expected.films.size());
    for (std::size_t k = 0; k < result.films.size(); ++k) {
      CHECK(result.films[k].mean() == expected.films[k].mean());
    }
  }
}

TEST_CASE("a file that has all its passes is left as it is, and its pictures come back") {
  const TempFolder folder;
  const RenderSettings settings = quiet_settings(3);
  const RenderResult expected = render_to(folder / "a.pvb", settings);
  const auto size = std::filesystem::file_size(folder / "a.pvb");
  const RenderResult result = resume(folder / "a.pvb", with(settings, 2));
  CHECK(std::filesystem::file_size(folder / "a.pvb") == size);
  CHECK(result.passes == 3);
  CHECK(result.films[0].mean() == expected.films[0].mean());
}

TEST_CASE("a file that was rendered otherwise is refused, named, and left as it is") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  const RenderSettings settings = quiet_settings(2);
  (void)render_to(path, settings);
  const Columns before = read_all(path);
  const auto size = std::filesystem::file_size(path);
  const auto names = [&](const auto& change, const std::string& key) {
    RenderSettings other = with(settings, 4);
    change(other);
    const std::string message = refusal(path, other);
    CAPTURE(message, key);
    CHECK(message.find(path) == 0);
    CHECK(message.find(" " + key + " ") != std::string::npos);
  };
  names([](RenderSettings& s) { s.sampler.seed = 5; }, "seed");
  names([](RenderSettings& s) { s.sampler.kind = SamplerKind::halton; }, "sampler");
  names([](RenderSettings& s) { s.sampler.enumeration = Enumeration::global; }, "enumeration");
  names([](RenderSettings& s) { s.integrator.split = 2; }, "split");
  names([](RenderSettings& s) { s.integrator.name = "direct"; }, "integrator");
  names([](RenderSettings& s) { s.integrator.max_depth = 3; }, "max_depth");
  names([](RenderSettings& s) { s.integrator.roulette_depth = 1; }, "roulette_depth");
  names([](RenderSettings& s) { s.integrator.ao_distance = 2; }, "ao_distance");
  names([](RenderSettings& s) { s.integrator.light_sampling = LightSampling::tree; },
        "light_sampling");
  names([](RenderSettings& s) { s.shade_rate = 2; }, "shade_rate");
  names([](RenderSettings& s) { s.producer = "psf-render 9"; }, "producer");
  names([](RenderSettings& s) { s.cameras = {1}; }, "cameras");
  names([](RenderSettings& s) { s.channels = {"normal"}; }, "channels:");
  names([](RenderSettings& s) { s.channels = {"default", "alpha"}; }, "channels:");
  CHECK(std::filesystem::file_size(path) == size);
  CHECK(read_all(path) == before);
}

TEST_CASE("a file of other light paths is refused, where the integrator has them") {
  const TempFolder folder;
  const auto names = [&](const std::string& integrator, const auto& change,
                         const std::string& key) {
    const std::string path = folder / (integrator + ".pvb");
    RenderSettings settings = quiet_settings(2);
    settings.integrator.name = integrator;
    if (!std::filesystem::exists(path)) (void)render_to(path, settings);
    settings.passes = 4;
    change(settings.integrator);
    const std::string message = refusal(path, settings);
    CAPTURE(message, key);
    CHECK((message.find(" " + key + " ") != std::string::npos) == !key.empty());
  };
  names(
      "vpl", [](IntegratorSettings& s) { s.vpl_paths = 3; }, "vpl_paths");
  names(
      "vpl", [](IntegratorSettings& s) { s.vpl_set = VplSet::pixel; }, "vpl_set");
  names(
      "vpl", [](IntegratorSettings& s) { s.vpl_distance = 3; }, "vpl_distance");
  names(
      "photon", [](IntegratorSettings& s) { s.photon_paths = 3; }, "photon_paths");
  names(
      "photon", [](IntegratorSettings& s) { s.photon_radius = 3; }, "photon_radius");
  names(
      "photon", [](IntegratorSettings& s) { s.photon_delta = 0.5f; }, "photon_delta");
  names(
      "path", [](IntegratorSettings& s) { s.photon_paths = 3, s.vpl_paths = 3; }, "");
}

TEST_CASE("a file of other material names is refused, one without any goes on") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  const RenderSettings settings = quiet_settings(2);
  (void)render_to(path, settings);
  const auto go_on = [&](const std::string& name) {
    Scene scene = two_camera_scene();
    scene.materials.resize(1);
    scene.materials[0].name = name;
    const FakeIntegrator integrator;
    const bool is_new = !std::filesystem::exists(path);
    const formats::Head head = make_head(scene, integrator, settings);
    formats::Writer writer =
        is_new ? formats::Writer(path, head, fast()) : formats::Writer::resume(path, head, fast());
    return render::render(scene, integrator, with(settings, is_new ? 2 : 4), &writer);
  };
  CHECK(go_on("wall").passes == 4);
  std::filesystem::remove(path);
  CHECK(go_on("wall").passes == 2);
  std::string refusal;
  try {
    (void)go_on("floor");
  } catch (const Error& error) {
    refusal = error.what();
  }
  CHECK(refusal.find(R"(rendered with materials ["wall"], now it is ["floor"])") !=
        std::string::npos);
  CHECK(go_on("wall").passes == 4);
}

TEST_CASE("a file without the renderer's state is refused") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  const RenderSettings settings = quiet_settings(2);
  (void)render_to(path, settings);
  {
    const Scene scene = two_camera_scene();
    formats::Writer writer =
        formats::Writer::resume(path, make_head(scene, FakeIntegrator(), settings), fast());
    std::vector<std::vector<std::byte>> columns;
    std::vector<const void*> pointers;
    for (const auto& channel : writer.head().channels) columns.emplace_back(channel.stride());
    for (const auto& column : columns) pointers.push_back(column.data());
    writer.append(1, pointers);
    writer.commit();
    writer.close();
  }
  CHECK(refusal(path, with(settings, 4)).find("no state of psf-render") != std::string::npos);
}

TEST_CASE("^C leaves a file that is not closed and goes on") {
  const TempFolder folder;
  RenderSettings settings = quiet_settings(5);
  const RenderResult expected = render_to(folder / "whole.pvb", settings);
  // What ^C leaves: passes committed, no closing commit.
  (void)render_to(folder / "a.pvb", with(settings, 3));
  const auto size = std::filesystem::file_size(folder / "a.pvb");
  std::filesystem::resize_file(folder / "a.pvb", size - 4096);
  CHECK_FALSE(formats::Reader(folder / "a.pvb").closed());
  const RenderResult result = resume(folder / "a.pvb", settings);
  CHECK(result.films[0].mean() == expected.films[0].mean());
  CHECK(read_all(folder / "a.pvb") == read_all(folder / "whole.pvb"));
}
