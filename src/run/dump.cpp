#include "run/dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.h"
#include "core/parallel.h"
#include "filter/places.h"
#include "formats/layout/channels.h"
#include "run/layer_columns.h"
#include "run/vertex_cut.h"

namespace psf::run {
namespace {

using formats::Type;

static_assert(sizeof(Vec3) == 3 * sizeof(float) && sizeof(Rgb) == 3 * sizeof(float),
              "columns of vectors are read as rows of 3 floats");

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

// What of alpha is not finite counts as covered.
void make_finite(std::vector<float>& coverage, std::uint64_t& not_finite) {
  not_finite = 0;
  for (float& value : coverage) {
    if (std::isfinite(value)) continue;
    value = 1;
    ++not_finite;
  }
}

}  // namespace

Dump::Dump(const std::string& path, const std::optional<VertexRule>& rule,
           std::optional<std::uint32_t> frame)
    : reader_(std::make_shared<formats::Reader>(path)),
      metadata_(metadata_of(*reader_)),
      rule_(rule) {
  if (rule_) static_cast<void>(VertexCut(*reader_, *rule_, metadata_.shade_rate));
  set_cameras(frame);
  if (reader_->records() == 0) {
    throw Error(ErrorCode::bad_input,
                path + ": holds no committed pass yet; wait for the renderer's first one");
  }
  set_pass_bounds();
}

void Dump::set_cameras(std::optional<std::uint32_t> frame) {
  const std::string& path = reader_->path();
  if (frame && metadata_.frames && *frame >= metadata_.frames->first) {
    const std::size_t k = *frame - metadata_.frames->first;
    if (k < metadata_.frames->cameras.size()) metadata_.cameras = metadata_.frames->cameras[k];
  }
  cameras_.clear();
  pixels_ = 0;
  if (metadata_.cameras.empty()) {
    throw Error(ErrorCode::bad_input,
                path +
                    ": the metadata name no camera; a picture needs its size: write "
                    "\"cameras\": [{\"width\": W, \"height\": H, \"angle_per_pixel\": A}]");
  }
  for (const formats::CameraInfo& camera : metadata_.cameras) {
    if (camera.width == 0 || camera.height == 0 ||
        std::uint64_t{camera.width} * camera.height > filter::kMostPixels - pixels_) {
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: {}: {} x {} is no size for a picture", path, called(camera),
                              camera.width, camera.height));
    }
    cameras_.push_back({camera.width, camera.height, camera.angle_per_pixel});
    pixels_ += std::uint64_t{camera.width} * camera.height;
  }
}

Dump Dump::of_frame(std::uint32_t frame) const {
  Dump other(*this);
  other.set_cameras(frame);
  return other;
}

Dump Dump::at(const std::optional<VertexRule>& rule) const {
  Dump other(*this);
  other.rule_ = rule;
  if (rule) static_cast<void>(VertexCut(*reader_, *rule, metadata_.shade_rate));
  return other;
}

std::uint64_t Dump::vertex_memory() const {
  return rule_ ? VertexCut(*reader_, *rule_, metadata_.shade_rate).memory() : 0;
}

bool Dump::makes_kind() const {
  return rule_ && VertexCut(*reader_, *rule_, metadata_.shade_rate).makes_kind();
}

bool Dump::refresh() {
  if (!reader_->refresh()) return false;
  set_pass_bounds();
  return true;
}

void Dump::set_pass_bounds() {
  pass_bounds_.clear();
  for (const formats::Pass& pass : reader_->passes()) pass_bounds_.push_back(pass.first);
  pass_bounds_.push_back(reader_->records());
}

bool Dump::has(std::string_view channel) const {
  return reader_->head().find(channel) &&
         (!rule_ || VertexCut(*reader_, *rule_, metadata_.shade_rate).has(channel));
}

std::optional<std::size_t> Dump::find(std::string_view channel) const {
  const std::optional<std::size_t> place = reader_->head().find(channel);
  if (!place || !has(channel)) return std::nullopt;
  const formats::Channel& found = reader_->head().channels[*place];
  const formats::ChannelInfo& known = *formats::channel_info(channel);
  const bool octahedral = found.encoding == formats::Encoding::octahedral;
  const bool fits =
      known.type == Type::f32 ? octahedral || is_float(found.type) : found.type == known.type;
  if (!fits || found.decoded_components() != known.components) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: channel {} is {} x {}, expected {} x {}; see formats/README.md",
                            reader_->path(), channel, formats::name_of(found.type),
                            found.components, formats::name_of(known.type), known.components));
  }
  return place;
}

std::size_t Dump::require(std::string_view channel, std::string_view wanted_by,
                          std::string_view instead) const {
  const std::optional<std::size_t> place = find(channel);
  if (place) return *place;
  if (rule_ && reader_->head().find(channel)) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: the vertices of {} have no channel {}, which {} needs; choose "
                            "first-rough{}",
                            reader_->path(), to_text(*rule_), channel, wanted_by,
                            instead.empty() ? "" : ", or " + std::string(instead)));
  }
  throw Error(ErrorCode::bad_input,
              fmt::format("{}: has no channel {}, which {} needs; render a dump that has it{}",
                          reader_->path(), channel, wanted_by,
                          instead.empty() ? "" : ", or " + std::string(instead)));
}

void Dump::require_angles() const {
  for (const formats::CameraInfo& camera : metadata_.cameras) {
    if (std::isfinite(camera.angle_per_pixel) && camera.angle_per_pixel > 0) continue;
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: {} has no angle per pixel, which a radius in pixels needs; write "
                            "\"angle_per_pixel\", in radians, into the metadata, or give the "
                            "radius as a fraction of the distance, `r0 0.02`",
                            reader_->path(), called(camera)));
  }
}

ChannelSet Dump::select(const filter::Parameters& parameters, bool guides) const {
  ChannelSet set;
  constexpr std::string_view filter = "the filter";
  set.position = require("position", filter);
  set.throughput = require("throughput", filter);
  set.contribution = require("contribution", filter);
  set.pixel = require("pixel", filter);
  if (filter::needs_distance(parameters)) {
    set.distance = require("distance", "a radius that depends on the distance");
  }
  if (filter::needs_angle(parameters)) require_angles();
  set.flags = find("flags");
  set.unfiltered = find("unfiltered");
  set.kind = find("kind");
  set.camera = cameras_.size() > 1 ? std::optional(require("camera", "a dump of several cameras"))
                                   : find("camera");
  for (const filter::ChannelNeed& need : filter::optional_channels(parameters)) {
    filter::for_each_channel([&](std::string_view name, const auto& member) {
      if (name == need.channel) member(set) = require(need.channel, need.wanted_by, need.instead);
    });
  }
  set.photons = photon_channels(*reader_, parameters);
  if (guides || parameters.pixels != filter::PixelRule::keep) {
    set.normal = find("normal");
    set.reflectance = find("reflectance");
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
  const auto add_task = [&](const std::optional<std::size_t>& place, auto& column) {
    if (!place) return column.clear();
    tasks.push_back([this, &range, &column, &make_room, count, place = *place] {
      make_room(column);
      if constexpr (std::is_integral_v<std::decay_t<decltype(column[0])>>) {
        reader_->read(place, range.first, count, std::as_writable_bytes(std::span(column)));
      } else {
        reader_->read_floats(place, range.first, count, as_floats(column));
      }
    });
  };
  filter::for_each_channel(
      [&](const char*, const auto& member) { add_task(member(channels), member(out)); });
  add_layer_tasks(*reader_, range, channels.layers, out, tasks);
  core::parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t) { tasks[begin](); });
  make_finite(out.coverage, out.not_finite_coverage);
  out.layer_views.clear();
  for (const BlockRecords::LayerColumns& layer : out.layers) {
    out.layer_views.push_back({layer.contribution.values, layer.unfiltered.values});
  }
  if (!channels.flags) out.flags.assign(count, filter::kHasVertex | filter::kShaded);
  // Where x_i is not read, nothing of it is asked for.
  if (rule_ && channels.position)
    VertexCut(*reader_, *rule_, metadata_.shade_rate).apply(range, out);
  if (channels.photons) read_photons(*reader_, *channels.photons, range, out.photons);
  check_pixels(range, out);
}

void Dump::check_pixels(const filter::PathRange& range, const BlockRecords& records) const {
  const std::optional<std::size_t> first =
      filter::first_misplaced(records.pixel, records.camera, cameras_);
  if (!first) return;
  const std::size_t i = *first, camera = records.camera.empty() ? 0 : records.camera[i];
  if (camera >= cameras_.size()) {
    throw Error(
        ErrorCode::bad_input,
        fmt::format(
            "{}: record {}: camera {} does not exist, the metadata name {}; render it again",
            reader_->path(), range.first + i, camera, cameras_.size()));
  }
  throw Error(
      ErrorCode::bad_input,
      fmt::format("{}: record {}: pixel {} is outside the {} x {} of {}; render it again",
                  reader_->path(), range.first + i, records.pixel[i], cameras_[camera].width,
                  cameras_[camera].height, called(metadata_.cameras[camera])));
}

}  // namespace psf::run
