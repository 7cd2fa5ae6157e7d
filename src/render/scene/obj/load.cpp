// OBJ with MTL to scenes: material libraries found, materials and meshes made. How MTL becomes our
// materials is documented in sample_data/README.md.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <unordered_map>

#include "core/error.h"
#include "render/scene/load_parts.h"
#include "render/scene/obj/file.h"
#include "render/scene/obj/mesh.h"
#include "render/scene/obj/mtl.h"
#include "render/scene/text_lines.h"

namespace psf::render {
namespace {

constexpr std::string_view kBlanks = " \t";

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
    const auto warn_of_missing = [&] {
      if (!missing.empty())
        warn(line.line, fmt::format("the material library {} cannot be opened", missing));
      missing = {};
    };
    while (!rest.empty()) {
      std::string found;
      std::size_t length = longest_file(rest, found);
      if (length > 0) {
        warn_of_missing();
        add_library(find_file(path_, found));
      } else {
        length = std::min(rest.find_first_of(kBlanks), rest.size());
        const char* const begin = missing.empty() ? rest.data() : missing.data();
        missing = {begin, static_cast<std::size_t>(rest.data() + length - begin)};
      }
      rest.remove_prefix(length);
      rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    }
    warn_of_missing();
  }

  // Characters of the longest run of words at the front that is a file, 0 for none. Of all the
  // words, or of a few: each try asks the file system.
  [[nodiscard]] std::size_t longest_file(std::string_view text, std::string& found) const {
    constexpr std::size_t kMostWords = 16;
    std::vector<std::size_t> lengths;
    for (std::size_t at = 0; at < text.size() && lengths.size() < kMostWords;
         at = std::min(text.find_first_not_of(kBlanks, lengths.back()), text.size())) {
      lengths.push_back(std::min(text.find_first_of(kBlanks, at), text.size()));
    }
    if (!lengths.empty() && lengths.back() < text.size()) lengths.push_back(text.size());
    for (; !lengths.empty(); lengths.pop_back()) {
      found = find_named(path_, text.substr(0, lengths.back()));
      if (!found.empty()) return lengths.back();
    }
    return 0;
  }

  void add_library(const std::string& library) {
    if (!libraries_.insert(library).second) return;
    scene_.files.push_back(library);
    LeftOut left_out;
    std::size_t doubles = 0;
    const MtlMaterial* first_double = nullptr;
    const std::vector<MtlMaterial> materials = read_mtl(library, left_out);
    for (const MtlMaterial& mtl : materials) {
      // Libraries are searched in their order.
      const auto [entry, is_new] =
          materials_.try_emplace(mtl.name, static_cast<int>(scene_.materials.size()));
      if (is_new) {
        scene_.materials.push_back(to_material(mtl, library, textures_, left_out));
      } else if (doubles++ == 0) {
        first_double = &mtl;
      }
    }
    left_out.warn(library, scene_);
    if (doubles > 0) {
      scene_.warnings.push_back(
          fmt::format("{}:{}: another material is called \"{}\", the first counts{}", library,
                      first_double->line, first_double->name,
                      doubles > 1 ? fmt::format("; {} more are like that", doubles - 1) : ""));
    }
  }

  int material_of(const ObjPart& part) {
    if (part.material.empty()) return plain_material();
    const auto found = materials_.find(part.material);
    if (found != materials_.end()) return found->second;
    // A comment may follow the name, but # is in many names.
    const std::size_t comment = part.material.find(" #");
    const auto bare = comment == std::string::npos
                          ? materials_.end()
                          : materials_.find(part.material.substr(
                                0, part.material.find_last_not_of(kBlanks, comment) + 1));
    if (bare != materials_.end()) return bare->second;
    if (missing_.empty()) missing_line_ = part.line;
    missing_.push_back(part.material);
    return materials_[part.material] = plain_material();
  }

  // The material of faces that have none.
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
