// The parts of the JSON scene loader. The schema is in sample_data/README.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/copy_count.h"
#include "render/json_cursor.h"
#include "render/load_parts.h"
#include "render/scene.h"

namespace psf::render {

// What the parts share while one JSON file is read.
struct JsonLoad {
  Scene& scene;
  TextureTable textures;
  CopyCount copies;

  explicit JsonLoad(Scene& target) : scene(target), textures(target) {}
};

// One material of "materials"; its name must be new.
void read_material(const JsonCursor& json, JsonLoad& load);
// Index of the material that the key "material" names; kNone where the key is missing and
// `required` is false.
[[nodiscard]] int read_material_name(const JsonCursor& json, const Scene& scene, bool required);

// Where a shape goes, of row vectors, p * m. Unless Space::exact the numbers are floats, and so are
// those of products.
using Placement = Imath::M44d;
[[nodiscard]] Placement product(const Placement& a, const Placement& b, bool exact);

// The keys "transform" and "repeat" of a shape: where each copy goes, at least one. Throws
// Error{limit} where there are more than kMaxCopies.
[[nodiscard]] std::vector<Placement> read_placements(const JsonCursor& json, bool exact);

// A shape and its copies, at all of `placements` (copies of the group around it).
void read_shape(const JsonCursor& json, const std::vector<Placement>& placements, JsonLoad& load,
                int depth = 0);

}  // namespace psf::render
