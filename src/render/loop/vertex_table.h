// The table `vertices` of a dump: formats/README.md, "Tables".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/light/trail.h"
#include "render/loop/table_columns.h"
#include "render/scene/space.h"

namespace psf::render {

struct VertexRow {
  std::uint32_t path;    // in its pass
  std::uint32_t parent;  // rows back; 0: the camera
  std::uint16_t depth;
  std::uint8_t flags;
  PathVertex vertex;
};

[[nodiscard]] const std::vector<TableColumn<VertexRow>>& vertex_columns();

// Adds the vertices of a path, in world units.
void add_vertices(std::span<const PathVertex> vertices, std::uint32_t path, const Space& space,
                  std::vector<VertexRow>& rows);

}  // namespace psf::render
