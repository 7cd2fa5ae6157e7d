// A loaded scene: plain data that the loaders fill and the light transport reads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/vec.h"
#include "render/scene/medium.h"
#include "render/scene/space.h"
#include "render/scene/texture.h"

namespace psf::render {

constexpr int kNone = -1;  // no texture, no light, no medium

enum class MaterialKind : std::uint8_t {
  diffuse,    // Lambert
  mirror,     // perfect, tinted by reflectance
  glass,      // smooth dielectric of index `ior`, transmission tinted by reflectance
  conductor,  // GGX, Fresnel by Schlick with `reflectance` at normal incidence
  coat,  // dielectric GGX coat of `ior` over a diffuse base; `metalness` blends it into a conductor
  gloss,  // GGX, Fresnel by Schlick with `specular` at normal incidence, over a diffuse base
  // The closed surface of a body that is filled with the medium `interior`: a dielectric of `ior`,
  // smooth or GGX, or without one, where `ior` is 1. The body is seen at its surface.
  subsurface,
  volume  // the same without a boundary that can be seen: what is seen is the medium in it
};

struct Material {
  std::string name;
  MaterialKind kind = MaterialKind::diffuse;
  Rgb reflectance{0.5f, 0.5f, 0.5f};
  int reflectance_texture = kNone;  // multiplies reflectance
  Rgb specular{0, 0, 0};            // reflectance of gloss at normal incidence
  float roughness = 0.5f;           // perceptual: GGX alpha = roughness^2
  float metalness = 0;
  bool multiple_scattering = true;  // of metals: light that bounces between microfacets is kept
  int roughness_metalness_texture = kNone;  // glTF: G multiplies roughness, B multiplies metalness
  // Of a coat: the share of it that has a second one of index 1.5 above it, clear, and its
  // perceptual roughness. The red of the one picture and the green of the other multiply them.
  float clearcoat = 0, clearcoat_roughness = 0;
  int clearcoat_texture = kNone, clearcoat_roughness_texture = kNone;
  float ior = 1.5f;
  int interior = kNone;  // index in Scene::media, of subsurface and volume alone
  // The share of the surface that is there: rays pass the rest. The red of the picture multiplies it.
  float opacity = 1;
  int opacity_texture = kNone;
  float opacity_cutoff = 0;  // above 0: all of it is there from this opacity on, and nothing below
  // Relief, which turns the shading normal: x of a tangent-space normal is along u, y along v, and
  // `normal_scale` multiplies both; of heights white is `bump_height` above black.
  int normal_texture = kNone;
  float normal_scale = 1;
  int bump_texture = kNone;
  float bump_height = 0;  // in the unit of the scene's space
  bool two_sided = true;  // false: the back side reflects nothing
  bool emits_two_sided = false;
  Rgb emission{0, 0, 0};  // radiance of the front side
  int emission_texture = kNone;

  // All its pictures.
  [[nodiscard]] std::array<int*, 8> textures() {
    return {&reflectance_texture, &roughness_metalness_texture,
            &opacity_texture,     &normal_texture,
            &bump_texture,        &emission_texture,
            &clearcoat_texture,   &clearcoat_roughness_texture};
  }
};

// A mesh at a moment.
struct MeshStep {
  std::vector<Vec3> positions, normals;  // as those of the mesh
};

// Triangles with one material. Counter-clockwise seen from the front.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // empty, or one unit vector per position
  std::vector<Vec2> uvs;      // empty, or one per position
  // Of a normal map: x, y, z along u, in any length, and w the side of v: the sign of
  // (normal x tangent) . v. Empty, or one per position; without them triangles have their own.
  std::vector<Imath::V4f> tangents;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int material = 0;
  // Where the mesh moves while the shutter is open: at even steps of Scene::shutter from begin to
  // end, straight on between them. Empty: it stands still.
  std::vector<MeshStep> motion;
  std::vector<Vec3> rest;  // the positions at frame 0; empty: those of now
};

struct Ball {
  Vec3 center{0, 0, 0};
  float radius = 1;
  bool operator==(const Ball&) const = default;
};

// A mesh of Scene::prototypes at a place, by p * placement. It emits nothing.
struct Instance {
  std::uint32_t prototype = 0;
  Mat4 placement;
};

struct Sphere {
  std::string name;
  Vec3 center{0, 0, 0};
  float radius = 1;  // front is outside
  int material = 0;
  std::vector<Ball> motion{};  // as that of a mesh
  std::optional<Ball> rest{};  // at frame 0
};

struct CurvePoint {
  Vec3 position{0, 0, 0};
  float radius = 0;

  bool operator==(const CurvePoint&) const = default;
};

// Round curves with one material: each segment is the hull of the balls around two points. Front is
// outside; they are neither glass nor lights.
struct Curves {
  std::string name;
  std::vector<CurvePoint> points;
  std::vector<std::uint32_t> segments;  // each from the point of this number to the next one
  int material = 0;
};

enum class LightKind : std::uint8_t { point, directional, spot };

// A light without surface. Lights with a surface are the emissive meshes and spheres.
struct Light {
  std::string name;
  LightKind kind = LightKind::point;
  Vec3 position{0, 0, 0};    // point, spot; Vec3() would leave it, and the hash, undefined
  Vec3 direction{0, 0, -1};  // directional, spot: unit, the direction in which light travels
  // point, spot: radiant intensity, in the scene's unit of length; directional: irradiance on a
  // facing surface
  Rgb intensity{1, 1, 1};
  float cos_inner = 1, cos_outer = 0;  // spot: full within inner, smooth falloff to 0 at outer
  float angle = 0;  // directional: angular radius in radians, 0 for a point at infinity
};

// Light from infinity: a constant sky, or an equirectangular map times `radiance`.
struct Environment {
  Rgb radiance{0, 0, 0};
  int texture = kNone;  // latitude-longitude; +y is up, the centre of the map looks along -z
  float rotation = 0;   // radians about +y
};

// Most pixels of a side of a picture, so that the number of a pixel fits 32 bits.
inline constexpr std::uint32_t kMaxSide = 65535;

// From when to when light comes in, in frames behind the camera's frame.
struct Shutter {
  float open = 0, close = 0;
  [[nodiscard]] bool blurs() const { return close > open; }
};

// What of a camera can move.
struct CameraPose {
  Vec3 eye{0, 0, 0}, target{0, 0, -1}, up{0, 1, 0};
  float fov = 0.7f, focus_distance = 1;
  bool operator==(const CameraPose&) const = default;
};
// In a straight line, up turned.
[[nodiscard]] CameraPose mix(const CameraPose& a, const CameraPose& b, float share);

struct Camera {
  std::string name;
  Vec3 eye{0, 0, 0}, target{0, 0, -1}, up{0, 1, 0};
  float fov = 0.7f;        // horizontal field of view, radians
  float vertical_fov = 0;  // where above 0, fov follows from it and the shape of the picture
  std::uint32_t width = 512, height = 512;
  float lens_radius = 0;     // 0: pinhole
  float focus_distance = 1;  // along the view axis, used where lens_radius > 0
  Shutter shutter;
  std::vector<CameraPose> motion;  // as that of a mesh; the members above are those of the frame

  [[nodiscard]] CameraPose pose() const { return {eye, target, up, fov, focus_distance}; }
  void set_pose(const CameraPose& pose);
};

// What a scene is loaded for.
struct Moment {
  double frame = 0;
  double fps = 24;  // frames a second, for files that count in seconds
  enum class Parts : std::uint8_t {
    all,
    places,  // where everything is: no pictures
    cameras  // these alone
  } parts = Parts::all;
};

// All coordinates and lengths are those of `space`, which is the world except for scenes that are
// far from the world's origin, huge or tiny.
struct Scene {
  std::string name;  // file name without folder
  // Hexadecimal, over everything that shapes the picture: files and what the command line changes.
  std::string hash;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Medium> media;
  std::vector<Mesh> meshes;
  std::vector<Mesh> prototypes;  // seen only where `instances` place them
  std::vector<Instance> instances;
  std::vector<Sphere> spheres;
  std::vector<Curves> curves;
  std::vector<Light> lights;
  Environment environment;
  int medium = kNone;  // index in `media` of what is between the surfaces
  std::vector<Camera> cameras;
  std::vector<std::string> files;     // other files that were read; some may occur more than once
  std::vector<std::string> warnings;  // what was repaired or left out while loading, one line each
  Moment moment;
  // What the file says of movement, for the hash; empty: nothing in it ever moves.
  std::vector<double> animation;
  Shutter shutter;  // around those of all cameras; rays have time 0 where it opens, 1 at its end
  Space space;
  Space wanted;  // where `exact` is set: the space in which the scene must be loaded instead
};

}  // namespace psf::render
