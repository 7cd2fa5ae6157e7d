// The channels that the filter looks at: each by its name in files and as the member of that name
// of Records, of run::BlockRecords and of run::ChannelSet. That of `alpha` is called `coverage`,
// since alpha_i is the throughput. What loops over all channels, loops here.
#pragma once

#include <string_view>

namespace psf::filter {

// Calls visit(name, member) for each channel; member(x) is x.NAME.
template <class Visit>
void for_each_channel(const Visit& visit) {
  visit(
      "flags", [](auto& of) -> auto& { return of.flags; });
  visit(
      "position", [](auto& of) -> auto& { return of.position; });
  visit(
      "distance", [](auto& of) -> auto& { return of.distance; });
  visit(
      "throughput", [](auto& of) -> auto& { return of.throughput; });
  visit(
      "contribution", [](auto& of) -> auto& { return of.contribution; });
  visit(
      "unfiltered", [](auto& of) -> auto& { return of.unfiltered; });
  visit(
      "pixel", [](auto& of) -> auto& { return of.pixel; });
  visit(
      "camera", [](auto& of) -> auto& { return of.camera; });
  visit(
      "normal", [](auto& of) -> auto& { return of.normal; });
  visit(
      "reflectance", [](auto& of) -> auto& { return of.reflectance; });
  visit(
      "visibility", [](auto& of) -> auto& { return of.visibility; });
  visit(
      "hit_distance", [](auto& of) -> auto& { return of.hit_distance; });
  visit(
      "direction", [](auto& of) -> auto& { return of.direction; });
  visit(
      "material", [](auto& of) -> auto& { return of.material; });
  visit(
      "roughness", [](auto& of) -> auto& { return of.roughness; });
  visit(
      "alpha", [](auto& of) -> auto& { return of.coverage; });
  visit(
      "kind", [](auto& of) -> auto& { return of.kind; });
  visit(
      "rest_position", [](auto& of) -> auto& { return of.rest_position; });
}

// Whether records have the channel of this name.
template <class Columns>
[[nodiscard]] bool has_channel(const Columns& records, std::string_view channel) {
  bool has = false;
  for_each_channel([&](std::string_view name, const auto& member) {
    has = has || (name == channel && !member(records).empty());
  });
  return has;
}

}  // namespace psf::filter
