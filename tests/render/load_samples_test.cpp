// The scenes in sample_data load without a warning, whole; cut or with a letter changed they never
// crash. Sponza, which is not ours, loads where it lies beside the project.
#include <ImathBox.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include "catch.h"
#include "load_support.h"
#include "read_text.h"
#include "shared_scenes.h"

namespace psf::render {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> sample_scenes() {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(fs::path(PSF_SOURCE_DIR) / "sample_data")) {
    if (entry.path().extension() == ".json") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

// Leaves bytes where the next function has its variables.
void litter(unsigned char with) {
  volatile unsigned char stack[1 << 16];
  for (auto& byte : stack) byte = with;
}

TEST_CASE("a sample scene has the same hash every time that it is loaded", "[load][hash]") {
  for (const fs::path& path : sample_scenes()) {
    litter(0x11);
    const std::string first = load_scene(path.string()).hash;
    litter(0x77);
    CHECK(load_scene(path.string()).hash == first);
  }
}

TEST_CASE("every sample scene loads without a warning and has light and camera",
          "[load][samples]") {
  const auto paths = sample_scenes();
  CHECK(paths.size() >= 9);
  for (const fs::path& path : paths) {
    INFO(path);
    const Scene scene = load_scene(path.string());
    CHECK(scene.warnings.empty());
    CHECK(!scene.cameras.empty());
    CHECK(fs::file_size(path) < 8000);
  }
}

TEST_CASE("a sample scene cut anywhere is malformed JSON", "[load][samples]") {
  const TempFolder folder;
  for (const fs::path& path : sample_scenes()) {
    const std::string text = psf::tests::read_text(path);
    const std::size_t end = text.find_last_of('}');
    for (std::size_t length = 0; length <= end; length += 61) {
      const Failure failure = load_failure(folder.write("cut.json", text.substr(0, length)));
      INFO(path << " cut to " << length);
      CHECK(failure.code == ErrorCode::bad_input);
      CHECK(contains(failure.message, "malformed JSON"));
    }
  }
}

TEST_CASE("a sample scene with a character changed loads or is an error of one line",
          "[load][samples]") {
  const TempFolder folder;
  const std::string text =
      psf::tests::read_text(fs::path(PSF_SOURCE_DIR) / "sample_data/cornell.json");
  std::size_t refused = 0, tried = 0;
  for (const char change : {'9', '-', '"', '}', 'x'}) {
    for (std::size_t i = 0; i < text.size(); i += 13) {
      std::string changed = text;
      changed[i] = change;
      const Failure failure = load_failure(folder.write("changed.json", changed));
      ++tried;
      if (failure.message.empty()) continue;
      ++refused;
      CHECK((failure.code == ErrorCode::bad_input || failure.code == ErrorCode::limit));
      CHECK(!contains(failure.message, "\n"));
    }
  }
  CHECK(refused > tried / 3);
}

TEST_CASE("Sponza loads with its textures", "[load][samples]") {
  const fs::path path = fs::path(tests::shared_scenes()) / "sponza/sponza.obj";
  if (!fs::exists(path)) SKIP("no sponza/ in a folder of shared scenes; name it in PSF_SCENES");
  const Scene scene = load_scene(path.string());
  std::size_t triangles = 0, textured = 0;
  Imath::Box3f box;
  for (const Mesh& mesh : scene.meshes) {
    triangles += mesh.triangles.size();
    for (const Vec3& p : mesh.positions) box.extendBy(p);
    textured +=
        scene.materials[static_cast<std::size_t>(mesh.material)].reflectance_texture != kNone;
  }
  CHECK(triangles == 66445);
  CHECK(scene.materials.size() == 19);
  CHECK(scene.textures.size() == 10);
  CHECK(textured > 20);
  CHECK(box.min.y == Approx(-0.9).margin(0.05));
  CHECK(box.max.x == Approx(17.4).margin(0.05));
}

}  // namespace
}  // namespace psf::render
