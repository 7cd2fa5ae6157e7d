// Animations of glTF: the translation, rotation and scale of nodes over time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/scene/gltf/parts.h"
#include "render/scene/keys.h"

namespace psf::render {
namespace {

GltfTrack read_track(GltfLoad& load, const JsonCursor& sampler, std::size_t components) {
  static constexpr std::string_view kKinds[] = {"LINEAR", "STEP", "CUBICSPLINE"};
  load.check_keys(sampler, {"input", "interpolation", "output"});
  GltfTrack track;
  track.components = components;
  const auto kind = sampler.find("interpolation");
  track.kind = kind ? static_cast<GltfTrack::Kind>(kind->choice(kKinds)) : GltfTrack::Kind::linear;
  const JsonCursor input = sampler.at("input"), output = sampler.at("output");
  for (const float time : read_floats(load, input, 1)) {
    if (!std::isfinite(time) || (!track.times.empty() && !(double{time} > track.times.back()))) {
      input.fail("the times of keys must be finite and grow from key to key");
    }
    track.times.push_back(double{time});
  }
  if (track.times.empty()) input.fail("has no keys");
  track.values = read_floats(load, output, components);
  const std::size_t values = track.kind == GltfTrack::Kind::cubic ? 3 : 1;
  if (track.values.size() != track.times.size() * values * components) {
    output.fail(fmt::format("{} values for {} keys, {} are needed",
                            track.values.size() / components, track.times.size(),
                            track.times.size() * values));
  }
  for (const float value : track.values) {
    if (!std::isfinite(value)) output.fail("has numbers that are not finite");
  }
  std::vector<double>& all = load.scene.animation;
  all.push_back(static_cast<double>(track.kind));
  all.insert(all.end(), track.times.begin(), track.times.end());
  all.insert(all.end(), track.values.begin(), track.values.end());
  return track;
}

void read_channel(GltfLoad& load, const JsonCursor& animation, const JsonCursor& channel) {
  static constexpr std::string_view kPaths[] = {"translation", "rotation", "scale"};
  load.check_keys(channel, {"sampler", "target"});
  const JsonCursor target = channel.at("target");
  load.check_keys(target, {"node", "path"});
  const auto node = target.find("node");
  const std::string path = target.at("path").text();
  if (path == "weights") return load.leave_out("morph targets are left out", channel.path());
  const auto known = std::find(std::begin(kPaths), std::end(kPaths), path);
  if (!node || known == std::end(kPaths)) {
    return load.leave_out("animations of other things than nodes are left out", channel.path());
  }
  const JsonCursor samplers = animation.at("samplers"), index = channel.at("sampler");
  const std::uint64_t number = index.whole();
  if (number >= samplers.size()) index.fail(fmt::format("there is no sampler {}", number));
  const std::uint64_t moved = node->whole();
  const auto nodes = load.root().find("nodes");
  if (moved >= (nodes ? nodes->size() : 0)) node->fail(fmt::format("there is no node {}", moved));
  const auto which = static_cast<std::size_t>(known - std::begin(kPaths));
  std::optional<GltfTrack>& track = load.tracks[moved][which];
  if (track) {
    return load.leave_out("animations are left out where another one moves the same node",
                          channel.path());
  }
  track = read_track(load, samplers.item(static_cast<std::size_t>(number)), which == 1 ? 4 : 3);
}

// The numbers of a track at a time; a rotation is not yet of unit length.
std::array<double, 4> value_at(const GltfTrack& track, double time) {
  const auto [key, share] = between(track.times, time);
  const bool cubic = track.kind == GltfTrack::Kind::cubic;
  const auto value = [&](std::size_t k, std::size_t c, std::size_t part) {
    const std::size_t place = cubic ? 3 * k + part : k;
    return double{track.values[place * track.components + c]};
  };
  std::array<double, 4> out{};
  for (std::size_t c = 0; c < track.components; ++c) out[c] = value(key, c, 1);
  if (share == 0 || track.kind == GltfTrack::Kind::step) return out;
  if (!cubic && track.components == 4) {
    const auto quaternion = [&](std::size_t k) {
      return Imath::Quatd(value(k, 3, 1), value(k, 0, 1), value(k, 1, 1), value(k, 2, 1))
          .normalized();
    };
    const Imath::Quatd q = Imath::slerpShortestArc(quaternion(key), quaternion(key + 1), share);
    return {q.v.x, q.v.y, q.v.z, q.r};
  }
  const double t = share, span = track.times[key + 1] - track.times[key];
  for (std::size_t c = 0; c < track.components; ++c) {
    const double a = value(key, c, 1), b = value(key + 1, c, 1);
    if (!cubic) {
      out[c] = a + (b - a) * t;
      continue;
    }
    // Hermite's spline; the tangents are per second.
    out[c] = (2 * t * t * t - 3 * t * t + 1) * a +
             span * (t * t * t - 2 * t * t + t) * value(key, c, 2) +
             (3 * t * t - 2 * t * t * t) * b + span * (t * t * t - t * t) * value(key + 1, c, 0);
  }
  return out;
}

}  // namespace

void read_gltf_animations(GltfLoad& load) {
  for (const JsonCursor& animation : load.root().items("animations")) {
    load.check_keys(animation, {"channels", "samplers"});
    for (const JsonCursor& channel : animation.items("channels")) {
      read_channel(load, animation, channel);
    }
  }
}

void animate_node(const GltfLoad& load, std::uint64_t node, GltfNodePose& pose) {
  const auto found = load.tracks.find(node);
  if (found == load.tracks.end()) return;
  const double time = load.scene.moment.frame / load.scene.moment.fps;
  const auto& [translation, rotation, scale] = found->second;
  const auto vector = [&](const GltfTrack& track) {
    const std::array<double, 4> v = value_at(track, time);
    return Imath::V3d(v[0], v[1], v[2]);
  };
  if (translation) pose.translation = vector(*translation);
  if (rotation) pose.rotation = value_at(*rotation, time);
  if (scale) pose.scale = vector(*scale);
}

}  // namespace psf::render
