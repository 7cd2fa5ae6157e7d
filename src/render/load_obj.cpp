// OBJ with MTL, by tinyobjloader. How MTL becomes our materials is documented in
// sample_data/README.md.
#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "formats/error.h"
#include "render/load_parts.h"

namespace psf::render {
namespace {

Rgb to_rgb(const tinyobj::real_t (&c)[3]) {
  return {c[0], c[1], c[2]};
}

// Phong exponent to perceptual roughness: alpha^2 = 2 / (Ns + 2), roughness^2 = alpha.
float roughness_of(float exponent) {
  return std::pow(2 / (std::max(exponent, 0.0f) + 2), 0.25f);
}

Material convert(const tinyobj::material_t& mtl) {
  Material material;
  material.name = mtl.name;
  material.two_sided = material.emits_two_sided = true;
  material.reflectance = to_rgb(mtl.diffuse);
  material.emission = to_rgb(mtl.emission);
  if (!mtl.emissive_texname.empty() && is_black(material.emission)) material.emission = Rgb(1);
  if (mtl.ior > 1) material.ior = mtl.ior;

  const Rgb specular = to_rgb(mtl.specular), transmittance = to_rgb(mtl.transmittance);
  const bool shiny = mtl.illum >= 2 && !is_black(specular);
  const bool colourless = is_black(material.reflectance) && mtl.diffuse_texname.empty();
  const bool refracts = mtl.illum == 4 || mtl.illum == 6 || mtl.illum == 7 || mtl.illum == 9;
  if (refracts || mtl.dissolve < 0.5f) {
    material.kind = MaterialKind::glass;
    material.reflectance = is_black(transmittance) ? Rgb(1) : transmittance;
  } else if (mtl.metallic > 0 || mtl.roughness > 0) {
    material.kind = MaterialKind::coat;
    material.roughness = mtl.roughness;
    material.metalness = mtl.metallic;
  } else if (shiny && colourless && (mtl.illum == 3 || mtl.illum == 5 || mtl.illum == 8)) {
    material.kind = MaterialKind::mirror;
    material.reflectance = specular;
  } else if (shiny) {
    material.kind = colourless ? MaterialKind::conductor : MaterialKind::coat;
    if (colourless) material.reflectance = specular;
    material.roughness = roughness_of(mtl.shininess);
  }
  return material;
}

// The MTL files that the OBJ names, in its folder.
class MtlReader : public tinyobj::MaterialReader {
 public:
  explicit MtlReader(const std::string& obj) : obj_(obj) {}
  bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                  std::map<std::string, int>* by_name, std::string* warning,
                  std::string* error) override {
    const std::string path = find_file(obj_, name);
    std::ifstream file(path, std::ios::binary);
    if (!file) {
      *warning += fmt::format("the material library {} cannot be opened\n", name);
      return false;
    }
    const std::size_t before = materials->size();
    tinyobj::LoadMtl(by_name, materials, &file, warning, error);
    for (std::size_t i = before; i < materials->size(); ++i) files_.resize(i + 1, path);
    return true;
  }
  // The MTL file of a material.
  [[nodiscard]] const std::string& file_of(std::size_t material) const {
    return files_.at(material);
  }

 private:
  const std::string& obj_;
  std::vector<std::string> files_;
};

struct CornerLess {
  bool operator()(const tinyobj::index_t& a, const tinyobj::index_t& b) const {
    return std::tie(a.vertex_index, a.normal_index, a.texcoord_index) <
           std::tie(b.vertex_index, b.normal_index, b.texcoord_index);
  }
};

// The faces of a shape that have one material, as a mesh of its own.
class MeshBuilder {
 public:
  MeshBuilder(const tinyobj::attrib_t& attributes, std::string name, int material)
      : attributes_(attributes) {
    mesh_.name = std::move(name);
    mesh_.material = material;
  }

  void add(const tinyobj::index_t* corners) {
    mesh_.triangles.push_back({index_of(corners[0]), index_of(corners[1]), index_of(corners[2])});
  }
  Mesh take() {
    if (!all_normals_) mesh_.normals.clear();
    if (!any_uv_) mesh_.uvs.clear();
    return std::move(mesh_);
  }

 private:
  std::uint32_t index_of(const tinyobj::index_t& corner) {
    const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto [entry, is_new] = known_.try_emplace(corner, next);
    if (!is_new) return entry->second;
    const auto at = [](const std::vector<tinyobj::real_t>& values, int index, std::size_t stride) {
      return values.data() + static_cast<std::size_t>(index) * stride;
    };
    const float* p = at(attributes_.vertices, corner.vertex_index, 3);
    mesh_.positions.emplace_back(p[0], p[1], p[2]);
    Vec3 normal(0, 0, 0);
    if (corner.normal_index >= 0) {
      const float* n = at(attributes_.normals, corner.normal_index, 3);
      normal = Vec3(n[0], n[1], n[2]);
    } else {
      all_normals_ = false;
    }
    mesh_.normals.push_back(normal);
    Vec2 uv(0, 0);
    if (corner.texcoord_index >= 0) {
      const float* t = at(attributes_.texcoords, corner.texcoord_index, 2);
      uv = Vec2(t[0], t[1]);
      any_uv_ = true;
    }
    mesh_.uvs.push_back(uv);
    return next;
  }

  const tinyobj::attrib_t& attributes_;
  std::map<tinyobj::index_t, std::uint32_t, CornerLess> known_;
  Mesh mesh_;
  bool all_normals_ = true, any_uv_ = false;
};

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw Error(ErrorCode::io, fmt::format("{}: cannot open: {}", path, std::strerror(errno)));
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Each line of what tinyobjloader said, once.
void add_warnings(const std::string& path, const std::string& text, Scene& scene) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string warning = path + ": " + line;
    const bool known =
        std::find(scene.warnings.begin(), scene.warnings.end(), warning) != scene.warnings.end();
    if (!line.empty() && !known) scene.warnings.push_back(warning);
  }
}

void add_shape(const tinyobj::attrib_t& attributes, const tinyobj::shape_t& shape,
               int default_material, Scene& scene) {
  std::map<int, MeshBuilder> parts;  // by material
  for (std::size_t f = 0; f < shape.mesh.num_face_vertices.size(); ++f) {
    const int id = f < shape.mesh.material_ids.size() ? shape.mesh.material_ids[f] : kNone;
    const int material = id >= 0 && id < default_material ? id : default_material;
    const std::string& material_name = scene.materials[static_cast<std::size_t>(material)].name;
    const auto [part, is_new] =
        parts.try_emplace(material, attributes, shape.name + "/" + material_name, material);
    part->second.add(&shape.mesh.indices[3 * f]);
  }
  for (auto& [material, part] : parts) scene.meshes.push_back(part.take());
}

}  // namespace

void load_obj(const std::string& path, Scene& scene) {
  std::string whole = read_text(path);
  check_obj(path, whole);
  std::istringstream text(std::move(whole));
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  MtlReader reader(path);
  if (!tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &text, &reader, true,
                        false)) {
    throw Error(ErrorCode::bad_input, path + ": " + error.substr(0, error.find('\n')));
  }
  add_warnings(path, warning + error, scene);

  TextureTable textures(scene);
  bool bumps = false;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const tinyobj::material_t& mtl = materials[i];
    Material material = convert(mtl);
    const std::string wanted_by = reader.file_of(i) + ": material " + mtl.name;
    const auto load = [&](const std::string& file) {
      return file.empty() ? kNone
                          : textures.load(reader.file_of(i), file, ColorSpace::srgb, wanted_by);
    };
    if (material.kind == MaterialKind::diffuse || material.kind == MaterialKind::coat) {
      material.reflectance_texture = load(mtl.diffuse_texname);
    }
    material.emission_texture = load(mtl.emissive_texname);
    bumps = bumps || !mtl.bump_texname.empty() || !mtl.normal_texname.empty();
    scene.materials.push_back(std::move(material));
  }
  if (bumps) scene.warnings.push_back(path + ": bump and normal maps are left out");

  // Faces without a material get one at the end, which goes again where there are none.
  const int default_material = static_cast<int>(materials.size());
  Material plain;
  plain.name = "default";
  plain.emits_two_sided = true;
  scene.materials.push_back(plain);
  for (const tinyobj::shape_t& shape : shapes)
    add_shape(attributes, shape, default_material, scene);
  const bool used = std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const Mesh& mesh) {
    return mesh.material == default_material;
  });
  if (!used) scene.materials.pop_back();
}

}  // namespace psf::render
