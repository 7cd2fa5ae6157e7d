// Asks Embree again: single rays, and packets.
#include "render/accel/replay.h"

#include <algorithm>

namespace psf::render {
namespace {

RTCRay embree_ray(const RecordedRay& ray) {
  RTCRay r;
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.tnear = ray.beyond;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.time = ray.time;
  r.tfar = ray.reach;
  r.mask = ~0u;
  r.id = 0;
  r.flags = 0;
  return r;
}

template <class Packet>
void set_lane(Packet& packet, std::size_t lane, const RecordedRay& ray) {
  auto& r = packet.ray;
  r.org_x[lane] = ray.origin.x;
  r.org_y[lane] = ray.origin.y;
  r.org_z[lane] = ray.origin.z;
  r.tnear[lane] = ray.beyond;
  r.dir_x[lane] = ray.direction.x;
  r.dir_y[lane] = ray.direction.y;
  r.dir_z[lane] = ray.direction.z;
  r.time[lane] = ray.time;
  r.tfar[lane] = ray.reach;
  r.mask[lane] = ~0u;
  r.id[lane] = 0;
  r.flags[lane] = 0;
  packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

#if RTC_VERSION_MAJOR >= 4
void intersect(const int* valid, RTCScene scene, RTCRayHit8& packet) {
  rtcIntersect8(valid, scene, &packet);
}
void intersect(const int* valid, RTCScene scene, RTCRayHit16& packet) {
  rtcIntersect16(valid, scene, &packet);
}
#else
template <class Call>
void with_context(const Call& call) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  call(&context);
}
void intersect(const int* valid, RTCScene scene, RTCRayHit8& packet) {
  with_context([&](auto* context) { rtcIntersect8(valid, scene, context, &packet); });
}
void intersect(const int* valid, RTCScene scene, RTCRayHit16& packet) {
  with_context([&](auto* context) { rtcIntersect16(valid, scene, context, &packet); });
}
#endif

template <class Packet, std::size_t width>
std::uint64_t replay_wide(RTCScene scene, std::span<const RecordedRay> rays) {
  std::uint64_t met = 0;
  for (std::size_t first = 0; first < rays.size(); first += width) {
    const std::size_t count = std::min(width, rays.size() - first);
    alignas(64) Packet packet;
    alignas(64) std::array<int, width> valid{};
    for (std::size_t lane = 0; lane < width; ++lane) {
      valid[lane] = lane < count ? -1 : 0;
      set_lane(packet, lane, rays[first + std::min(lane, count - 1)]);
    }
    intersect(valid.data(), scene, packet);
    for (std::size_t lane = 0; lane < count; ++lane)
      met += packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
  }
  return met;
}

}  // namespace

std::uint64_t replay(const Accel& accel, std::span<const RecordedRay> rays) {
  std::uint64_t met = 0;
  for (const RecordedRay& ray : rays) {
    if (ray.occlusion) {
      RTCRay query = embree_ray(ray);
      embree_occluded(accel.embree(), query);
      met += query.tfar < 0 ? 1 : 0;
      continue;
    }
    RTCRayHit query;
    query.ray = embree_ray(ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    embree_intersect(accel.embree(), query);
    met += query.hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
  }
  return met;
}

std::uint64_t replay_packets(const Accel& accel, std::span<const RecordedRay> rays,
                             std::size_t width) {
  return width == 8 ? replay_wide<RTCRayHit8, 8>(accel.embree(), rays)
                    : replay_wide<RTCRayHit16, 16>(accel.embree(), rays);
}

}  // namespace psf::render
