// OBJ with MTL to scenes: material libraries found, materials and meshes made. How MTL becomes our
// materials is documented in sample_data/README.md.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <unordered_map>

#include "formats/error.h"
#include "render/load_parts.h"
#include "render/mtl.h"
#include "render/obj_file.h"
#include "render/obj_mesh.h"
#include "render/text_lines.h"

namespace psf::render {
namespace {

class ObjLoad {
 public:
  ObjLoad(const std::string& path, Scene& scene)
      : path_(path), scene_(scene), textures_(scene, true) {}

  void run() {
    LeftOut left_out;
    const ObjFile file = read_obj(path_, scene_.space, left_out);
    if (!scene_.space.exact) {
      // In floats, faces may be no faces far from the origin.
      scene_.wanted = moved_space(scene_.space, file.bounds);
      if (scene_.wanted.exact) return;
    }
    for (const ObjFile::Libraries& line : file.libraries) add_libraries(line);
    ObjMeshes meshes(path_, file);
    for (const ObjPart& part : file.parts) {
      const int material = material_of(part);
      scene_.meshes.push_back(meshes.make(part));
      Mesh& mesh = scene_.meshes.back();
      mesh.material = material;
      mesh.name = part.object + "/" + scene_.materials[static_cast<std::size_t>(material)].name;
    }
    left_out.warn(path_, scene_);
    meshes.warn(scene_);
    warn_of_missing();
  }

 private:
  // The names of one line are parted by spaces, but have some too: the longest run of words that is
  // a file counts as one name.
  void add_libraries(const ObjFile::Libraries& line) {
    std::string_view rest = line.names;
    std::string_view missing;  // words one after the other that are no file
    const auto warn_of = [&] {
      if (missing.empty()) return;
      warn(line.line, fmt::format("the material library {} cannot be opened", missing));
      missing = {};
    };
    while (!rest.empty()) {
      const std::string_view start = rest;
      std::size_t length = rest.size();
      std::string found;
      while (length > 0 && (found = find_named(path_, rest.substr(0, length))).empty()) {
        const std::size_t space = rest.substr(0, length).find_last_of(" \t");
        length =
            space == std::string_view::npos ? 0 : rest.substr(0, space).find_last_not_of(" \t") + 1;
      }
      if (found.empty()) {
        length = std::min(rest.find_first_of(" \t"), rest.size());
        missing =
            missing.empty()
                ? rest.substr(0, length)
                : std::string_view(missing.data(),
                                   static_cast<std::size_t>(rest.data() + length - missing.data()));
      } else {
        warn_of();
        add_library(find_file(path_, found));
      }
      rest.remove_prefix(length);
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
      if (rest.size() == start.size()) break;
    }
    warn_of();
  }

  void add_library(const std::string& library) {
    if (!libraries_.insert(library).second) return;
    LeftOut left_out;
    for (const MtlMaterial& mtl : read_mtl(library, left_out)) {
      // Libraries are searched in their order.
      const auto [entry, is_new] =
          materials_.try_emplace(mtl.name, static_cast<int>(scene_.materials.size()));
      if (!is_new) {
        scene_.warnings.push_back(
            fmt::format("{}:{}: another material is called \"{}\", the first counts", library,
                        mtl.line, mtl.name));
        continue;
      }
      scene_.materials.push_back(to_material(mtl, library, textures_, left_out));
    }
    left_out.warn(library, scene_);
  }

  int material_of(const ObjPart& part) {
    if (part.material.empty()) return plain_material();
    auto found = materials_.find(part.material);
    // A comment may follow the name, but # is in many names.
    if (found == materials_.end())
      found = materials_.find(part.material.substr(
          0, part.material.find_last_not_of(" \t", part.material.find(" #")) + 1));
    if (found != materials_.end()) return found->second;
    if (std::find(missing_.begin(), missing_.end(), part.material) == missing_.end()) {
      if (missing_.empty()) missing_line_ = part.line;
      missing_.push_back(part.material);
    }
    return plain_material();
  }

  // Of faces without a material.
  int plain_material() {
    if (plain_ == kNone) {
      Material plain;
      plain.name = "default";
      plain.emits_two_sided = true;
      plain_ = static_cast<int>(scene_.materials.size());
      scene_.materials.push_back(std::move(plain));
    }
    return plain_;
  }

  void warn_of_missing() {
    constexpr std::size_t kMost = 8;
    if (missing_.empty()) return;
    const std::size_t shown = std::min(missing_.size(), kMost);
    std::string names;
    for (std::size_t i = 0; i < shown; ++i)
      names += fmt::format("{}\"{}\"", i == 0 ? "" : ", ", missing_[i]);
    if (shown < missing_.size()) names += fmt::format(" and {} more", missing_.size() - shown);
    warn(missing_line_, "no material library has " + names + ": grey instead");
  }

  void warn(std::size_t line, const std::string& what) {
    scene_.warnings.push_back(fmt::format("{}:{}: {}", path_, line, what));
  }

  const std::string& path_;
  Scene& scene_;
  TextureTable textures_;
  std::set<std::string> libraries_;
  std::unordered_map<std::string, int> materials_;  // by name
  int plain_ = kNone;
  std::vector<std::string> missing_;
  std::size_t missing_line_ = 0;
};

}  // namespace

void load_obj(const std::string& path, Scene& scene) {
  ObjLoad(path, scene).run();
}

}  // namespace psf::render
