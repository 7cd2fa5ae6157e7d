// The table of channels, and the columns behind it.
#include "render/loop/recorder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/error.h"
#include "formats/read/reader.h"

namespace psf::render {
namespace {

template <class T>
const void* bytes(const std::vector<T>& values) {
  return values.data();
}

struct LayerChannel {
  std::string name;
  std::span<Rgb> LayerSums::*part;
  std::size_t layer;
};

std::vector<LayerChannel> layer_channels(std::span<const LayerInfo> layers) {
  std::vector<LayerChannel> channels;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const auto& [name, contribution, unfiltered] = layers[k];
    if (contribution) channels.push_back({"contribution." + name, &LayerSums::contribution, k});
    if (unfiltered) channels.push_back({"unfiltered." + name, &LayerSums::unfiltered, k});
  }
  return channels;
}

}  // namespace

// One row a channel: the file's side and the recorder's.
struct ColumnTable {
  enum class Use { always, standard, asked };  // standard: unless others are asked for
  struct Row {
    formats::Channel channel;
    Use use;
    const void* (*data)(const Recorder&);
  };
  static const std::vector<Row>& rows() {
    using formats::Type;
    using R = const Recorder&;
    constexpr Use always = Use::always, standard = Use::standard, asked = Use::asked;
    static_assert(
        sizeof(Vec2) == 8 && sizeof(VertexKind) == 1 && sizeof(Vec3) == 12 && sizeof(Rgb) == 12,
        "vectors are stored as they lie");
    static const std::vector<Row> table{
        {{"position", Type::f32, 3}, always, [](R r) { return bytes(r.position_); }},
        {{"normal", Type::f32, 3}, standard, [](R r) { return bytes(r.normal_); }},
        {{"reflectance", Type::f32, 3}, standard, [](R r) { return bytes(r.reflectance_); }},
        {{"throughput", Type::f32, 3}, always, [](R r) { return bytes(r.throughput_); }},
        {{"contribution", Type::f32, 3}, always, [](R r) { return bytes(r.contribution_); }},
        {{"unfiltered", Type::f32, 3}, always, [](R r) { return bytes(r.unfiltered_); }},
        {{"distance", Type::f32, 1}, always, [](R r) { return bytes(r.distance_); }},
        {{"pixel", Type::u32, 1}, always, [](R r) { return bytes(r.pixel_); }},
        {{"flags", Type::u8, 1}, always, [](R r) { return bytes(r.flags_); }},
        {{"camera", Type::u16, 1}, standard, [](R r) { return bytes(r.camera_); }},
        {{"visibility", Type::u32, 1}, standard, [](R r) { return bytes(r.visibility_); }},
        {{"hit_distance", Type::f32, 1}, standard, [](R r) { return bytes(r.hit_distance_); }},
        {{"direction", Type::f32, 3}, standard, [](R r) { return bytes(r.direction_); }},
        {{"material", Type::u32, 1}, standard, [](R r) { return bytes(r.material_); }},
        {{"roughness", Type::f32, 1}, standard, [](R r) { return bytes(r.roughness_); }},
        {{"film", Type::f32, 2}, asked, [](R r) { return bytes(r.film_); }},
        {{"lens", Type::f32, 2}, asked, [](R r) { return bytes(r.lens_); }},
        {{"time", Type::f32, 1}, asked, [](R r) { return bytes(r.time_); }},
        {{"frame", Type::u32, 1}, asked, [](R r) { return bytes(r.frame_); }},
        {{"alpha", Type::f32, 1}, asked, [](R r) { return bytes(r.coverage_); }},
        {{"kind", Type::u8, 1}, asked, [](R r) { return bytes(r.kind_); }},
        {{kRestPosition, Type::f32, 3}, asked, [](R r) { return bytes(r.rest_); }}};
    return table;
  }
};

std::vector<formats::Channel> record_channels(std::span<const std::string> optional,
                                              std::span<const LayerInfo> layers, bool has_volumes) {
  using Use = ColumnTable::Use;
  const auto& rows = ColumnTable::rows();
  for (const std::string& name : optional) {
    const auto is_named = [&](const auto& row) { return row.channel.name == name; };
    if (name == kDefaultChannels || name == kAllChannels) continue;
    if (std::any_of(rows.begin(), rows.end(), is_named)) continue;
    std::vector<std::string> names;
    for (const auto& row : rows) {
      if (row.use != Use::always) names.push_back(row.channel.name);
    }
    names.insert(names.end(), {std::string(kDefaultChannels), std::string(kAllChannels)});
    throw Error(ErrorCode::usage, fmt::format("no channel is called \"{}\"; there are {}", name,
                                              fmt::join(names, ", ")));
  }
  const auto has = [&](std::string_view name) {
    return std::find(optional.begin(), optional.end(), name) != optional.end();
  };
  const bool all = has(kAllChannels), standard = optional.empty() || has(kDefaultChannels);
  std::vector<formats::Channel> channels;
  for (const auto& row : rows) {
    const bool is_standard =
        row.use == Use::standard || (has_volumes && row.channel.name == "kind");
    const bool by_set = all || row.use == Use::always || (standard && is_standard);
    if (by_set || has(row.channel.name)) channels.push_back(row.channel);
  }
  for (const LayerChannel& layer : layer_channels(layers)) {
    channels.push_back({layer.name, formats::Type::f32, 3});
  }
  return channels;
}

bool has_sample(std::span<const formats::Channel> channels) {
  return std::any_of(channels.begin(), channels.end(), [](const formats::Channel& channel) {
    const std::string& name = channel.name;
    return name == "film" || name == "lens" || name == "time" || name == "frame";
  });
}

Recorder::Recorder(std::size_t capacity, std::span<const LayerInfo> layers,
                   std::span<const formats::Channel> channels)
    : position_(capacity),
      normal_(capacity),
      direction_(capacity),
      reflectance_(capacity),
      throughput_(capacity),
      contribution_(capacity),
      unfiltered_(capacity),
      distance_(capacity),
      hit_distance_(capacity),
      roughness_(capacity),
      pixel_(capacity),
      visibility_(capacity),
      material_(capacity),
      camera_(capacity),
      flags_(capacity) {
  for (const auto& [name, part, layer] : layer_channels(layers)) {
    layers_.push_back({name, part, layer, std::vector<Rgb>(capacity)});
  }
  const auto make_room = [&](std::string_view name, auto& column) {
    const auto is_named = [&](const formats::Channel& channel) { return channel.name == name; };
    if (std::any_of(channels.begin(), channels.end(), is_named)) column.resize(capacity);
  };
  make_room("film", film_);
  make_room("lens", lens_);
  make_room("time", time_);
  make_room("frame", frame_);
  make_room("alpha", coverage_);
  make_room("kind", kind_);
  make_room(kRestPosition, rest_);
}

void Recorder::set(std::size_t slot, std::uint16_t camera, std::uint32_t pixel,
                   const PathRecord& record, const LayerSums& sums) {
  position_[slot] = record.position;
  normal_[slot] = record.normal;
  direction_[slot] = record.direction;
  reflectance_[slot] = record.reflectance;
  throughput_[slot] = record.throughput;
  contribution_[slot] = record.contribution;
  unfiltered_[slot] = record.unfiltered;
  distance_[slot] = record.distance;
  hit_distance_[slot] = record.hit_distance;
  roughness_[slot] = record.roughness;
  pixel_[slot] = pixel;
  visibility_[slot] = record.visibility;
  material_[slot] = record.material;
  camera_[slot] = camera;
  flags_[slot] = static_cast<std::uint8_t>((record.has_vertex ? kHasVertexFlag : 0) |
                                           (record.shaded ? kShadedFlag : 0));
  if (!coverage_.empty()) coverage_[slot] = record.coverage;
  if (!kind_.empty()) kind_[slot] = record.kind;
  if (!rest_.empty()) rest_[slot] = record.rest;
  for (LayerColumn& column : layers_) column.values[slot] = (sums.*column.part)[column.layer];
}

void Recorder::set_sample(std::size_t slot, const CameraSample& sample) {
  if (!film_.empty()) film_[slot] = sample.film;
  if (!lens_.empty()) lens_[slot] = sample.lens;
  if (!time_.empty()) time_[slot] = sample.time;
  if (!frame_.empty()) frame_[slot] = sample.frame;
}

std::vector<const void*> Recorder::columns(std::span<const formats::Channel> channels) const {
  std::vector<const void*> result;
  for (const formats::Channel& channel : channels) {
    for (const auto& row : ColumnTable::rows()) {
      if (row.channel.name == channel.name) result.push_back(row.data(*this));
    }
    for (const LayerColumn& column : layers_) {
      if (column.channel == channel.name) result.push_back(column.values.data());
    }
  }
  return result;
}

void Recorder::load(const formats::Reader& reader, std::uint64_t first, std::size_t count) {
  for (const auto& row : ColumnTable::rows()) {
    if (row.use != ColumnTable::Use::always) continue;
    // The column is this object's own, which is not const here.
    auto* column = static_cast<std::byte*>(const_cast<void*>(row.data(*this)));
    reader.read(reader.require(row.channel.name, "the picture"), first, count,
                {column, count * row.channel.stride()});
  }
}

std::uint64_t Recorder::add_to(film::Film& film, std::size_t count,
                               std::uint32_t shade_rate) const {
  std::uint64_t left_out = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (shade_rate > 1 && (flags_[i] & kShadedFlag) == 0) continue;
    Rgb radiance = unfiltered_[i];
    if ((flags_[i] & kHasVertexFlag) != 0) radiance += throughput_[i] * contribution_[i];
    if (is_finite(radiance)) {
      film.add(pixel_[i], radiance);
    } else {
      ++left_out;
    }
  }
  return left_out;
}

}  // namespace psf::render
