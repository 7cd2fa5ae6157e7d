// Sequences: dumps of several frames, and a dump a frame.
#include "render/job/frames.h"

#include "core/parallel.h"
#include "formats/layout/metadata.h"
#include "formats/read/reader.h"
#include "motion_support.h"

namespace psf::render {
namespace {

const std::string kMovingScene = moving_scene(
    R"(, "keyframes": [{"frame": 0}, {"frame": 4, "translate": [1, 0, 0]}])",
    R"(, "shutter": [0, 0.5], "keyframes": [{"frame": 0}, {"frame": 4, "eye": [0, 0, 1], "fov": 60}])");

formats::Metadata sequence_metadata(const std::string& path) {
  return formats::parse_metadata(formats::Reader(path).head().metadata);
}

// Of a sequence of 2 passes a frame, the values of a frame.
template <class T>
std::vector<T> frame_values(const tests::Columns& columns, const std::string& channel,
                            std::size_t k) {
  const auto all = tests::values<T>(columns, channel);
  constexpr std::size_t kPaths = 2 * 32 * 32;
  return {all.begin() + static_cast<std::ptrdiff_t>(k * kPaths),
          all.begin() + static_cast<std::ptrdiff_t>((k + 1) * kPaths)};
}

}  // namespace

TEST_CASE("A sequence has the records that each frame has by itself, and says which is which") {
  const tests::TempFolder folder;
  Job job = quiet_job(written(folder, "s.json", kMovingScene), folder / "a.pvb", 2);
  job.settings.frames = FrameRange{1, 3};
  const JobResult result = run_job(job);
  CHECK(result.render.passes == 6);
  CHECK(result.render.paths == 6 * 32 * 32);
  const tests::Columns all = tests::read_all(job.output);

  job.output = folder / "b.####.pvb";
  CHECK(run_job(job).render.passes == 6);
  for (std::uint32_t k = 0; k < 3; ++k) {
    CAPTURE(k);
    const std::string path = numbered(job.output, 1 + k);
    const tests::Columns one = tests::read_all(path);
    CHECK(frame_values<Vec3>(all, "position", k) == tests::values<Vec3>(one, "position"));
    CHECK(frame_values<Vec3>(all, "contribution", k) == tests::values<Vec3>(one, "contribution"));
    CHECK(frame_values<std::uint32_t>(all, "frame", k) ==
          std::vector<std::uint32_t>(2 * 32 * 32, 1 + k));
    const formats::Metadata m = sequence_metadata(path);
    REQUIRE(m.frames.has_value());
    CHECK((m.frames->first == 1 + k && m.frames->count == 1 && m.frames->passes == 2));
    CHECK(m.cameras[0].camera_to_world[11] == Approx(0.25 * (1 + k)));
  }
}

TEST_CASE("The metadata of a sequence have its cameras at each frame, where they move") {
  const tests::TempFolder folder;
  Job job = quiet_job(written(folder, "s.json", kMovingScene), folder / "a.pvb", 1);
  job.settings.channels.clear();
  job.settings.frames = FrameRange{0, 5};
  static_cast<void>(run_job(job));
  const formats::Metadata m = sequence_metadata(job.output);
  REQUIRE(m.frames.has_value());
  REQUIRE(m.frames->cameras.size() == 5);
  for (std::size_t k = 0; k < 5; ++k) {
    const formats::CameraInfo& camera = m.frames->cameras[k].at(0);
    CHECK(camera.camera_to_world[11] == Approx(0.25 * static_cast<double>(k)));
    CHECK((camera.name == "c" && camera.width == 32 && camera.height == 32));
  }
  CHECK(m.frames->cameras[0][0] == m.cameras[0]);
  CHECK(m.frames->cameras[4][0].angle_per_pixel > m.cameras[0].angle_per_pixel);
  // The channel of frames comes by itself.
  CHECK(formats::Reader(job.output).head().find("frame").has_value());

  job.scene = written(folder, "still.json", moving_scene(""));
  job.output = folder / "b.pvb";
  static_cast<void>(run_job(job));
  CHECK(sequence_metadata(job.output).frames->cameras.empty());
}

TEST_CASE("A sequence that was stopped goes on within any frame, for any number of threads") {
  const tests::TempFolder folder;
  Job job = quiet_job(written(folder, "s.json", kMovingScene), folder / "a.pvb", 2);
  job.settings.frames = FrameRange{0, 3};
  static_cast<void>(run_job(job));
  const tests::Columns whole = tests::read_all(job.output);
  job.resume = true;
  job.output = folder / "b.pvb";
  job.settings.time_limit = 1e-9;  // each run ends after a pass
  for (std::uint64_t passes = 1; passes <= 6; ++passes) {
    const core::ThreadLimit limit(passes % 2 == 0 ? 1 : 0);
    CHECK(run_job(job).render.passes == passes);
  }
  CHECK(tests::read_all(job.output) == whole);
  // Pictures of frames that are all there are made of their records.
  job.settings.time_limit = 1e9;
  job.images = {folder / "p.####.exr"};
  const JobResult again = run_job(job);
  CHECK(again.images.size() == 3);
  CHECK(again.render.passes == 6);
  CHECK(tests::read_all(job.output) == whole);
  // Another number of frames or passes is another sequence.
  job.settings.frames = FrameRange{0, 4};
  std::string refusal;
  try {
    static_cast<void>(run_job(job));
  } catch (const Error& error) {
    refusal = error.what();
  }
  CHECK(refusal.find("rendered with frames count 3, now it is 4;") != std::string::npos);
}

TEST_CASE("Frames that would share a picture are refused") {
  Job job = quiet_job("none.json", "", 1);
  job.settings.frames = FrameRange{0, 2};
  job.images = {"a.exr"};
  CHECK_THROWS_WITH(run_job(job),
                    "a.exr: a picture a frame needs #### in its name, for the frame's "
                    "number");
  CHECK(numbered("a.####.exr", 7) == "a.0007.exr");
  CHECK(numbered("a.####.exr", 12345) == "a.12345.exr");
}

}  // namespace psf::render
