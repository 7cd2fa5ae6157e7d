#include "render/loop/photon_table.h"

namespace psf::render {

const std::vector<TableColumn<PhotonRow>>& photon_columns() {
  using formats::Type;
  using R = const PhotonRow&;
  static const std::vector<TableColumn<PhotonRow>> kColumns{
      {{"path", Type::u32, 1}, [](R r) -> const void* { return &r.path; }},
      {{"position", Type::f32, 3}, [](R r) -> const void* { return &r.position; }},
      {{"normal", Type::f32, 3}, [](R r) -> const void* { return &r.normal; }},
      {{"direction", Type::f32, 3}, [](R r) -> const void* { return &r.direction; }},
      {{"power", Type::f32, 3}, [](R r) -> const void* { return &r.power; }},
      {{"depth", Type::u16, 1}, [](R r) -> const void* { return &r.depth; }},
      {{"light", Type::u32, 1}, [](R r) -> const void* { return &r.light; }},
      {{"material", Type::u32, 1}, [](R r) -> const void* { return &r.material; }}};
  return kColumns;
}

std::vector<PhotonRow> trace_photon_rows(const Transport& transport, const Space& space,
                                         const SamplerSettings& sampler, std::uint64_t pass,
                                         std::uint64_t paths, const LightPaths::Some& some,
                                         std::uint64_t& rays) {
  // Power is radiance times area, and areas are those of the scene's space.
  const float unit = space.world_length(1);
  const float scale = unit * unit / static_cast<float>(paths);
  const auto keep = [&](const LightVertex& v, std::vector<PhotonRow>& rows) {
    const Surface& at = v.at.surface;
    rows.push_back({static_cast<std::uint32_t>(v.path),
                    space.is_world() ? at.position : Vec3(space.world(at.position)), at.normal,
                    v.at.out, v.power * scale, static_cast<std::uint16_t>(v.depth - 1),
                    static_cast<std::uint32_t>(v.light), static_cast<std::uint32_t>(at.material)});
  };
  return LightPaths(transport).collect_some<PhotonRow>(sampler, pass, paths, some, rays, keep);
}

}  // namespace psf::render
