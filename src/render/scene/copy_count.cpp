#include "render/scene/copy_count.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "core/error.h"
#include "render/scene/load_parts.h"

namespace psf::render {

void CopyCount::add(const JsonCursor& place, std::size_t primitives, std::size_t vertices,
                    std::size_t copies, bool instanced) {
  if (instanced) return add(place, primitives + copies, vertices, 1);
  if (primitives > (kMaxPrimitives - primitives_) / copies) {
    throw Error(ErrorCode::limit,
                fmt::format("{}: {} copies of {} triangles are more than psf takes ({} in a scene)",
                            place.where(), copies, primitives, kMaxPrimitives));
  }
  if (vertices > std::numeric_limits<std::uint32_t>::max() / copies) {
    throw Error(ErrorCode::limit, place.where() + ": the copies have more than 2^32 vertices");
  }
  primitives_ += primitives * copies;
}

}  // namespace psf::render
