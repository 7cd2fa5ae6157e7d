// Points as boxes without extent in a structure of Embree's.
#include "render/accel/point_index.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace psf::render {
namespace {

struct BallQuery {
  const Vec3* points;
  Vec3 center;
  float radius_sq;
  std::vector<std::uint32_t>* found;
};

void point_bounds(const RTCBoundsFunctionArguments* arguments) {
  const Vec3& p = static_cast<const Vec3*>(arguments->geometryUserPtr)[arguments->primID];
  RTCBounds& bounds = *arguments->bounds_o;
  bounds.lower_x = bounds.upper_x = p.x;
  bounds.lower_y = bounds.upper_y = p.y;
  bounds.lower_z = bounds.upper_z = p.z;
}

bool add_if_within(RTCPointQueryFunctionArguments* arguments) {
  const auto& ball = *static_cast<const BallQuery*>(arguments->userPtr);
  if (length_sq(ball.points[arguments->primID] - ball.center) <= ball.radius_sq) {
    ball.found->push_back(arguments->primID);
  }
  return false;  // the radius stays
}

}  // namespace

PointIndex::PointIndex(std::vector<Vec3> points) : points_(std::move(points)) {
  if (points_.size() > kMost) {
    throw Error(ErrorCode::limit,
                fmt::format("{} light vertices a pass, at most {} are possible; trace fewer paths",
                            points_.size(), kMost));
  }
  if (points_.empty()) return;
  device_.reset(rtcNewDevice(nullptr));
  scene_.reset(rtcNewScene(device_.get()));
  check_embree(device_.get(), "no scene for points");
  const EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER));
  rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(points_.size()));
  rtcSetGeometryUserData(geometry.get(), points_.data());
  rtcSetGeometryBoundsFunction(geometry.get(), point_bounds, nullptr);
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene_.get(), geometry.get());
  rtcCommitScene(scene_.get());
  check_embree(device_.get(), "points");
}

void PointIndex::within(const Vec3& center, float radius, std::vector<std::uint32_t>& found) const {
  if (scene_ == nullptr) return;
  BallQuery ball{points_.data(), center, radius * radius, &found};
  // A hair wider, so that it is add_if_within() alone that decides.
  RTCPointQuery query{center.x, center.y, center.z, 0, radius * (1 + 0x1p-16f)};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto first = static_cast<std::ptrdiff_t>(found.size());
  rtcPointQuery(scene_.get(), &query, &context, add_if_within, &ball);
  std::sort(found.begin() + first, found.end());
}

}  // namespace psf::render
