#include "run/dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.h"
#include "core/parallel.h"

namespace psf::run {
namespace {

using formats::Type;

static_assert(sizeof(Vec3) == 3 * sizeof(float) && sizeof(Rgb) == 3 * sizeof(float),
              "columns of vectors are read as rows of 3 floats");

// Largest picture of all cameras together; a damaged size must not become an allocation.
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 32;

constexpr std::size_t kCheckGrain = 65536;  // records a range

std::span<float> as_floats(std::vector<float>& column) {
  return column;
}
template <typename Vector>
std::span<float> as_floats(std::vector<Vector>& column) {
  return column.empty() ? std::span<float>() : std::span<float>(&column[0].x, 3 * column.size());
}

formats::Metadata metadata_of(const formats::Reader& reader) {
  try {
    return formats::parse_metadata(reader.head().metadata);
  } catch (const Error& error) {
    throw Error(error.code(), reader.path() + ": metadata: " + error.what());
  }
}

std::string called(const formats::CameraInfo& camera) {
  return camera.name.empty() ? "its camera" : fmt::format("camera \"{}\"", camera.name);
}

// Floats of any width are taken, integers only as the format has them.
bool is_float(Type type) {
  return type == Type::f16 || type == Type::f32 || type == Type::f64;
}

}  // namespace

Dump::Dump(const std::string& path) : reader_(path), metadata_(metadata_of(reader_)) {
  if (metadata_.cameras.empty()) {
    throw Error(ErrorCode::bad_input,
                path +
                    ": the metadata name no camera; a picture needs its size: write "
                    "\"cameras\": [{\"width\": W, \"height\": H, \"angle_per_pixel\": A}]");
  }
  for (const formats::CameraInfo& camera : metadata_.cameras) {
    if (camera.width == 0 || camera.height == 0 ||
        std::uint64_t{camera.width} * camera.height > kMaxPixels - pixels_) {
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: {}: {} x {} is no size for a picture", path, called(camera),
                              camera.width, camera.height));
    }
    cameras_.push_back({camera.width, camera.height, camera.angle_per_pixel});
    pixels_ += std::uint64_t{camera.width} * camera.height;
  }
  if (reader_.records() == 0) {
    throw Error(ErrorCode::bad_input,
                path + ": holds no committed pass yet; wait for the renderer's first one");
  }
  set_pass_bounds();
}

bool Dump::refresh() {
  if (!reader_.refresh()) return false;
  set_pass_bounds();
  return true;
}

void Dump::set_pass_bounds() {
  pass_bounds_.clear();
  for (const formats::Pass& pass : reader_.passes()) pass_bounds_.push_back(pass.first);
  pass_bounds_.push_back(reader_.records());
}

std::optional<std::size_t> Dump::find(const char* channel, Type type,
                                      std::size_t components) const {
  const std::optional<std::size_t> place = reader_.head().find(channel);
  if (!place) return std::nullopt;
  const formats::Channel& found = reader_.head().channels[*place];
  const bool octahedral = found.encoding == formats::Encoding::octahedral;
  const bool fits = type == Type::f32 ? octahedral || is_float(found.type) : found.type == type;
  if (!fits || found.decoded_components() != components) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: channel {} is {} x {}, expected {} x {}; see formats/README.md",
                            reader_.path(), channel, formats::name_of(found.type), found.components,
                            formats::name_of(type), components));
  }
  return place;
}

std::size_t Dump::require(const char* channel, Type type, std::size_t components,
                          std::string_view wanted_by, std::string_view instead) const {
  const std::optional<std::size_t> place = find(channel, type, components);
  if (place) return *place;
  throw Error(ErrorCode::bad_input,
              fmt::format("{}: has no channel {}, which {} needs; render a dump that has it{}",
                          reader_.path(), channel, wanted_by,
                          instead.empty() ? "" : ", or " + std::string(instead)));
}

void Dump::require_angles() const {
  for (const formats::CameraInfo& camera : metadata_.cameras) {
    if (std::isfinite(camera.angle_per_pixel) && camera.angle_per_pixel > 0) continue;
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: {} has no angle per pixel, which a radius in pixels needs; write "
                            "\"angle_per_pixel\", in radians, into the metadata, or give the "
                            "radius as a fraction of the distance, --r0 0.02",
                            reader_.path(), called(camera)));
  }
}

ChannelSet Dump::select(const filter::Parameters& parameters, bool guides) const {
  ChannelSet set;
  constexpr std::string_view filter = "the filter";
  set.position = require("position", Type::f32, 3, filter);
  set.throughput = require("throughput", Type::f32, 3, filter);
  set.contribution = require("contribution", Type::f32, 3, filter);
  set.pixel = require("pixel", Type::u32, 1, filter);
  if (parameters.radius.basis != filter::RadiusBasis::world ||
      parameters.estimator == filter::Estimator::disk) {
    set.distance = require("distance", Type::f32, 1, "a radius that depends on the distance");
  }
  if (parameters.radius.basis == filter::RadiusBasis::footprint ||
      parameters.estimator == filter::Estimator::disk) {
    require_angles();
  }
  set.flags = find("flags", Type::u8, 1);
  set.unfiltered = find("unfiltered", Type::f32, 3);
  set.camera = cameras_.size() > 1
                   ? std::optional(require("camera", Type::u16, 1, "a dump of several cameras"))
                   : find("camera", Type::u16, 1);
  for (const filter::ChannelNeed& need : filter::optional_channels(parameters)) {
    const auto set_needed = [&](std::optional<std::size_t>& place, const char* channel, Type type,
                                std::size_t components) {
      if (need.channel != channel) return;
      place = require(channel, type, components, need.wanted_by, need.instead);
    };
    set_needed(set.normal, "normal", Type::f32, 3);
    set_needed(set.reflectance, "reflectance", Type::f32, 3);
    set_needed(set.visibility, "visibility", Type::u32, 1);
    set_needed(set.hit_distance, "hit_distance", Type::f32, 1);
    set_needed(set.direction, "direction", Type::f32, 3);
    set_needed(set.material, "material", Type::u32, 1);
    set_needed(set.roughness, "roughness", Type::f32, 1);
  }
  if (guides) {
    set.normal = find("normal", Type::f32, 3);
    set.reflectance = find("reflectance", Type::f32, 3);
  }
  return set;
}

void Dump::read(const filter::PathRange& range, const ChannelSet& channels,
                BlockRecords& out) const {
  const auto count = static_cast<std::size_t>(range.size());
  std::vector<std::function<void()>> tasks;
  // In the task: a column's first touch costs as much as its reading.
  const auto make_room = [count](auto& column) {
    if (column.capacity() < count) column = {};  // no old values beside the new ones
    column.resize(count);
  };
  const auto floats = [&](std::optional<std::size_t> channel, auto& column) {
    if (!channel) return column.clear();
    tasks.push_back([this, &range, &column, &make_room, count, place = *channel] {
      make_room(column);
      reader_.read_floats(place, range.first, count, as_floats(column));
    });
  };
  const auto integers = [&](std::optional<std::size_t> channel, auto& column) {
    if (!channel) return column.clear();
    tasks.push_back([this, &range, &column, &make_room, count, place = *channel] {
      make_room(column);
      reader_.read(place, range.first, count, std::as_writable_bytes(std::span(column)));
    });
  };
  floats(channels.position, out.position);
  floats(channels.distance, out.distance);
  floats(channels.throughput, out.throughput);
  floats(channels.contribution, out.contribution);
  floats(channels.unfiltered, out.unfiltered);
  floats(channels.normal, out.normal);
  floats(channels.reflectance, out.reflectance);
  floats(channels.hit_distance, out.hit_distance);
  floats(channels.direction, out.direction);
  floats(channels.roughness, out.roughness);
  integers(channels.flags, out.flags);
  integers(channels.pixel, out.pixel);
  integers(channels.camera, out.camera);
  integers(channels.visibility, out.visibility);
  integers(channels.material, out.material);
  core::parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t) { tasks[begin](); });
  if (!channels.flags) out.flags.assign(count, filter::kHasVertex | filter::kShaded);
  check_pixels(range, out);
}

void Dump::check_pixels(const filter::PathRange& range, const BlockRecords& records) const {
  const auto camera_of = [&records](std::size_t i) -> std::size_t {
    return records.camera.empty() ? 0 : records.camera[i];
  };
  const auto is_good = [&](std::size_t i) {
    const std::size_t camera = camera_of(i);
    return camera < cameras_.size() &&
           records.pixel[i] < std::uint64_t{cameras_[camera].width} * cameras_[camera].height;
  };
  const std::size_t count = records.pixel.size();
  std::vector<std::size_t> bad(core::range_count(count, kCheckGrain), count);  // the first a range
  core::parallel_for(count, kCheckGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (is_good(i)) continue;
      bad[begin / kCheckGrain] = i;
      return;
    }
  });
  const auto first = std::find_if(bad.begin(), bad.end(), [&](std::size_t i) { return i < count; });
  if (first == bad.end()) return;
  const std::size_t i = *first, camera = camera_of(i);
  if (camera >= cameras_.size()) {
    throw Error(
        ErrorCode::bad_input,
        fmt::format(
            "{}: record {}: camera {} does not exist, the metadata name {}; render it again",
            reader_.path(), range.first + i, camera, cameras_.size()));
  }
  throw Error(ErrorCode::bad_input,
              fmt::format("{}: record {}: pixel {} is outside the {} x {} of {}; render it again",
                          reader_.path(), range.first + i, records.pixel[i], cameras_[camera].width,
                          cameras_[camera].height, called(metadata_.cameras[camera])));
}

}  // namespace psf::run
