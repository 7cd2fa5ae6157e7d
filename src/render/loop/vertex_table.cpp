#include "render/loop/vertex_table.h"

namespace psf::render {

const std::vector<TableColumn<VertexRow>>& vertex_columns() {
  using formats::Type;
  using R = const VertexRow&;
  static const std::vector<TableColumn<VertexRow>> kColumns{
      {{"path", Type::u32, 1}, [](R r) -> const void* { return &r.path; }},
      {{"parent", Type::u32, 1}, [](R r) -> const void* { return &r.parent; }},
      {{"depth", Type::u16, 1}, [](R r) -> const void* { return &r.depth; }},
      {{"flags", Type::u8, 1}, [](R r) -> const void* { return &r.flags; }},
      {{"position", Type::f32, 3}, [](R r) -> const void* { return &r.vertex.position; }},
      {{"distance", Type::f32, 1}, [](R r) -> const void* { return &r.vertex.distance; }},
      {{"normal", Type::f32, 3}, [](R r) -> const void* { return &r.vertex.normal; }},
      {{"reflectance", Type::f32, 3}, [](R r) -> const void* { return &r.vertex.reflectance; }},
      {{"roughness", Type::f32, 1}, [](R r) -> const void* { return &r.vertex.roughness; }},
      {{"material", Type::u32, 1}, [](R r) -> const void* { return &r.vertex.material; }},
      {{"direction", Type::f32, 3}, [](R r) -> const void* { return &r.vertex.direction; }},
      {{"outgoing", Type::f32, 3}, [](R r) -> const void* { return &r.vertex.outgoing; }},
      {{"pdf", Type::f32, 1}, [](R r) -> const void* { return &r.vertex.pdf; }},
      {{"lobe", Type::u8, 1}, [](R r) -> const void* { return &r.vertex.lobe; }},
      {{"throughput", Type::f32, 3}, [](R r) -> const void* { return &r.vertex.throughput; }},
      {{"emission", Type::f32, 3}, [](R r) -> const void* { return &r.vertex.emission; }},
      {{"direct", Type::f32, 3}, [](R r) -> const void* { return &r.vertex.direct; }},
      {{"background", Type::f32, 3}, [](R r) -> const void* { return &r.vertex.background; }}};
  return kColumns;
}

void add_vertices(std::span<const PathVertex> vertices, std::uint32_t path, const Space& space,
                  std::vector<VertexRow>& rows) {
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    VertexRow row{path, k > 0 ? 1u : 0u, static_cast<std::uint16_t>(k),
                  static_cast<std::uint8_t>(vertices[k].selected ? 1 : 0), vertices[k]};
    if (!space.is_world()) {
      row.vertex.position = Vec3(space.world(row.vertex.position));
      row.vertex.distance = space.world_length(row.vertex.distance);
    }
    rows.push_back(row);
  }
}

}  // namespace psf::render
