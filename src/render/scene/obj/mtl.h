// Material libraries (MTL) of OBJ files: reads them, and turns their materials into psf's.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/load_parts.h"

namespace psf::render {

class LeftOut;

// The statements of one material; values that it does not give are not set. Colours are linear Rec.
// 709; those of reflection and transmission are in [0, 1].
struct MtlMaterial {
  std::string name;
  std::size_t line = 0;  // line of its newmtl statement
  std::optional<Rgb> ka, kd, ks, tf, ke;
  std::optional<float> d, tr;  // opacity; transparency, given in place of opacity
  std::optional<float> ns, ni, pr, pm;
  std::optional<int> illum;
  struct Map {
    std::string file;      // empty: no map
    std::size_t line = 0;  // line of the statement
    float multiplier = 1;  // of a relief: its option -bm
  };
  Map map_kd, map_ke, map_d, relief;
};

// Reads every statement of a library and checks its numbers. Statements without effect are added to
// `left_out`. Throws Error{bad_input} naming file and line, Error{io} where the file cannot be
// read.
[[nodiscard]] std::vector<MtlMaterial> read_mtl(const std::string& path, LeftOut& left_out);

// Converts to psf's material as described in sample_data/README.md. `path`: the library's path,
// which the paths of maps are relative to.
[[nodiscard]] Material to_material(const MtlMaterial& mtl, const std::string& path,
                                   TextureTable& textures, LeftOut& left_out);

}  // namespace psf::render
