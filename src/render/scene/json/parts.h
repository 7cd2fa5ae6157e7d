// The parts of the JSON scene loader. The schema is in sample_data/README.md.
#pragma once

#include <cmath>
#include <memory>
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
  bool moves = false;  // the shape that is read, or a group around it, has keyframes

  explicit JsonLoad(Scene& target) : scene(target), textures(target) {}
};

// Values that may be missing; the integers are from 1 to `most`. The seed is 0 where it is missing.
[[nodiscard]] std::uint32_t integer_or(const JsonCursor& json, std::string_view key,
                                       std::uint32_t most, std::uint32_t otherwise);
[[nodiscard]] double real_or(const JsonCursor& json, std::string_view key, const Range& range,
                             double otherwise);
[[nodiscard]] std::uint64_t read_seed(const JsonCursor& json);

// Reads the key "density" of a medium; null where only places are wanted.
[[nodiscard]] std::shared_ptr<const DensityGrid> read_density(const JsonCursor& json, Scene& scene);
// Reads one medium of "media"; its name must be new.
void read_medium(const JsonCursor& json, Scene& scene);
// The index of the medium that `key` names, which must be there.
[[nodiscard]] int read_medium_name(const JsonCursor& json, std::string_view key,
                                   const Scene& scene);

// Reads one material of "materials"; its name must be new.
void read_material(const JsonCursor& json, JsonLoad& load);
// The index of the material that `key` names; kNone where the key is missing and
// `required` is false.
[[nodiscard]] int read_material_name(const JsonCursor& json, const Scene& scene, bool required,
                                     std::string_view key = "material");

// The transform of a shape, for row vectors, p * m. Unless Space::exact is set, its numbers, and
// those of products, are rounded to float.
using Placement = Imath::M44d;
[[nodiscard]] Placement product(const Placement& a, const Placement& b, bool exact);

// How many times larger a transform makes everything; none where that is not the same along all
// axes. T: float or double.
template <class T>
[[nodiscard]] std::optional<T> even_scale(const Imath::Matrix44<T>& m) {
  // The rows of the linear part: the images of the axes.
  const Imath::Vec3<T> x(m[0][0], m[0][1], m[0][2]), y(m[1][0], m[1][1], m[1][2]),
      z(m[2][0], m[2][1], m[2][2]);
  const T scale = x.length();
  const T slack = static_cast<T>(1e-4f) * scale;
  const bool even = std::abs(y.length() - scale) <= slack &&
                    std::abs(z.length() - scale) <= slack && std::abs(x.dot(y)) <= slack * scale &&
                    std::abs(x.dot(z)) <= slack * scale && std::abs(y.dot(z)) <= slack * scale;
  return even ? std::optional(scale) : std::nullopt;
}

// Each of `inner` moved by each of `outer`. Throws Error{limit} where they are more than kMaxCopies.
[[nodiscard]] std::vector<Placement> combine(const JsonCursor& json,
                                             const std::vector<Placement>& inner,
                                             const std::vector<Placement>& outer, bool exact);

// The placements of a shape's copies, at least one, by its keys "transform", "keyframes", "repeat"
// and "scatter". Throws Error{limit} where there are more than kMaxCopies.
[[nodiscard]] std::vector<Placement> read_placements(const JsonCursor& json, Scene& scene);

constexpr Range kFovRange{0.01, 179.99, "of degrees in (0, 180)"};
// These read "keyframes": the placement, and the pose of the camera, at the scene's frame. What they
// read goes into Scene::animation. The second returns whether a key says where it is in focus.
[[nodiscard]] Placement read_keyed_placement(const JsonCursor& json, Scene& scene);
bool move_camera(const JsonCursor& json, Scene& scene, Camera& camera);

// Reads a shape and adds its copies at each of `placements`, which are the copies of the
// surrounding group. `depth`: number of groups around the shape.
void read_shape(const JsonCursor& json, const std::vector<Placement>& placements, JsonLoad& load,
                int depth = 0);

// Adds the copies of `mesh`, and counts them; errors name the shape.
void add_mesh(const JsonCursor& json, const Mesh& mesh, const std::vector<Placement>& placements,
              JsonLoad& load);

// Adds the surfaces of a mesh file with its materials, or with `material` for all; its lights and
// cameras stay out.
void add_mesh_file(const JsonCursor& json, int material, bool flipped,
                   const std::vector<Placement>& placements, JsonLoad& load);

// Shapes that are grown from a seed, and curves (`hairball`: grown too).
void add_curves(const JsonCursor& json, bool hairball, const std::string& name, int material,
                const std::vector<Placement>& placements, JsonLoad& load);
void add_tree(const JsonCursor& json, const std::string& name, int material,
              const std::vector<Placement>& placements, JsonLoad& load);
[[nodiscard]] Mesh read_noise_sphere(const JsonCursor& json);
[[nodiscard]] Mesh read_tuft(const JsonCursor& json);
// The placements of the key "scatter".
[[nodiscard]] std::vector<Placement> read_scatter(const JsonCursor& json);

}  // namespace psf::render
