// Material libraries (MTL) of OBJ files: what they say, and what becomes of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "render/load_parts.h"

namespace psf::render {

class LeftOut;

// What one material says; nothing where it does not. Colours are linear Rec. 709, those of
// reflection and transmission in [0, 1].
struct MtlMaterial {
  std::string name;
  std::size_t line = 0;  // of its newmtl
  std::optional<Rgb> ka, kd, ks, tf, ke;
  std::optional<float> d, tr;  // opacity, and transparency instead
  std::optional<float> ns, ni, pr, pm;
  std::optional<int> illum;
  struct Map {
    std::string file;      // empty for none
    std::size_t line = 0;  // where it is named
  };
  Map map_kd, map_ke;
};

// Every statement of a library, its numbers checked where they stand; what becomes nothing is added
// to `left_out`. Throws Error{bad_input} naming file and line, Error{io} where it cannot be read.
[[nodiscard]] std::vector<MtlMaterial> read_mtl(const std::string& path, LeftOut& left_out);

// Our material, as sample_data/README.md has it. `path`: of the library, for the maps.
[[nodiscard]] Material to_material(const MtlMaterial& mtl, const std::string& path,
                                   TextureTable& textures, LeftOut& left_out);

}  // namespace psf::render
