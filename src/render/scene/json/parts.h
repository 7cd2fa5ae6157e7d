// The parts of the JSON scene loader. The schema is in sample_data/README.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/scene/copy_count.h"
#include "render/scene/json/cursor.h"
#include "render/scene/load_parts.h"
#include "render/scene/scene.h"

namespace psf::render {

// The state that the parts share while one JSON file is read.
struct JsonLoad {
  Scene& scene;
  TextureTable textures;
  CopyCount copies;

  explicit JsonLoad(Scene& target) : scene(target), textures(target) {}
};

// Reads one medium of "media"; its name must be new.
void read_medium(const JsonCursor& json, Scene& scene);
// The index of the medium that `key` names, which must be there.
[[nodiscard]] int read_medium_name(const JsonCursor& json, std::string_view key,
                                   const Scene& scene);

// Reads one material of "materials"; its name must be new.
void read_material(const JsonCursor& json, JsonLoad& load);
// The index of the material that the key "material" names; kNone where the key is missing and
// `required` is false.
[[nodiscard]] int read_material_name(const JsonCursor& json, const Scene& scene, bool required);

// The transform of a shape, for row vectors, p * m. Unless Space::exact is set, its numbers, and
// those of products, are rounded to float.
using Placement = Imath::M44d;
[[nodiscard]] Placement product(const Placement& a, const Placement& b, bool exact);

// The placements of a shape's copies, at least one, by its keys "transform" and "repeat". Throws
// Error{limit} where there are more than kMaxCopies.
[[nodiscard]] std::vector<Placement> read_placements(const JsonCursor& json, bool exact);

// Reads a shape and adds its copies at each of `placements`, which are the copies of the
// surrounding group. `depth`: number of groups around the shape.
void read_shape(const JsonCursor& json, const std::vector<Placement>& placements, JsonLoad& load,
                int depth = 0);

}  // namespace psf::render
