// The recorder's columns and sums against the records put in.
#include "render/loop/recorder.h"

#include <cstring>
#include <limits>

#include "catch.h"
#include "core/error.h"
#include "formats/layout/channels.h"

using namespace psf;
using namespace psf::render;

namespace {

std::vector<std::string> names(const std::vector<formats::Channel>& channels) {
  std::vector<std::string> result;
  for (const auto& channel : channels) result.push_back(channel.name);
  return result;
}

// Component k of record i of a float channel.
float value(const Recorder& recorder, const std::string& channel, std::size_t i, std::size_t k) {
  const auto channels = record_channels();
  const auto columns = recorder.columns(channels);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (channels[c].name != channel) continue;
    float result;
    std::memcpy(&result, static_cast<const char*>(columns[c]) + i * channels[c].stride() + 4 * k,
                4);
    return result;
  }
  return std::numeric_limits<float>::quiet_NaN();
}

}  // namespace

TEST_CASE("the default channels, or the ones asked for beside those that every file has") {
  CHECK(record_channels().size() == 15);
  std::size_t bytes = 0;
  for (const auto& channel : record_channels()) bytes += channel.stride();
  CHECK(bytes == 111);
  const std::vector<std::string> wanted{"roughness", "normal"};
  CHECK(names(record_channels(wanted)) ==
        std::vector<std::string>{"position", "normal", "throughput", "contribution", "unfiltered",
                                 "distance", "pixel", "flags", "roughness"});
  const std::vector<std::string> set{"default"}, more{"alpha", "default", "normal"}, all{"all"};
  CHECK(names(record_channels(set)) == names(record_channels()));
  CHECK(record_channels(more).size() == 16);
  CHECK(record_channels(more).back().name == "alpha");
  CHECK(record_channels(all).size() == 22);
  const std::vector<std::string> unknown{"normals"};
  CHECK_THROWS_AS(record_channels(unknown), Error);
}

TEST_CASE("columns hold what was set, non-finite values included") {
  Recorder recorder(4);
  PathRecord record;
  record.position = Vec3(1, 2, 3);
  record.normal = Vec3(4, 5, 6);
  record.reflectance = Rgb(7, 8, 9);
  record.throughput = Rgb(10, 11, 12);
  record.contribution = Rgb(13, 14, 15);
  record.unfiltered = Rgb(16, 17, 18);
  record.direction = Vec3(19, 20, 21);
  record.distance = 22;
  record.hit_distance = std::numeric_limits<float>::infinity();
  record.roughness = 0.5f;
  recorder.set(2, 0, 0, record);
  float expected = 1;
  for (const char* channel : {"position", "normal", "reflectance", "throughput", "contribution",
                              "unfiltered", "direction"}) {
    for (std::size_t k = 0; k < 3; ++k) CHECK(value(recorder, channel, 2, k) == expected++);
  }
  CHECK(value(recorder, "distance", 2, 0) == 22);
  CHECK(value(recorder, "hit_distance", 2, 0) == std::numeric_limits<float>::infinity());
  CHECK(value(recorder, "roughness", 2, 0) == 0.5f);
}

TEST_CASE("columns on request hold what was set, and take no room otherwise") {
  const std::vector<std::string> wanted{"film",  "lens", "time",         "frame",
                                        "alpha", "kind", "rest_position"};
  const auto channels = record_channels(wanted);
  Recorder recorder(2, {}, channels);
  PathRecord record;
  record.coverage = 0.25f;
  record.kind = VertexKind::volume;
  record.rest = Vec3(1, 2, 3);
  recorder.set(1, 0, 0, record);
  recorder.set_sample(1, {{1.5f, 2.5f}, {-0.5f, 0.75f}, 0.125f, 42});
  const auto columns = recorder.columns(channels);
  const auto at = [&]<class T>(const char* name, std::size_t k, T) {
    for (std::size_t c = 0; c < channels.size(); ++c) {
      if (channels[c].name == name) return static_cast<const T*>(columns[c])[k];
    }
    return T();
  };
  CHECK(at("film", 1, Vec2()) == Vec2(1.5f, 2.5f));
  CHECK(at("lens", 1, Vec2()) == Vec2(-0.5f, 0.75f));
  CHECK(at("time", 1, 0.0f) == 0.125f);
  CHECK(at("frame", 1, 0u) == 42);
  CHECK(at("alpha", 1, 0.0f) == 0.25f);
  CHECK(at("kind", 1, std::uint8_t{0}) == 2);
  CHECK(at("rest_position", 1, Vec3()) == Vec3(1, 2, 3));
  Recorder plain(2);
  plain.set(1, 0, 0, record);
  plain.set_sample(1, {});
  for (const void* column : plain.columns(record_channels())) CHECK(column != nullptr);
}

TEST_CASE("the picture gets u + alpha c, c only where there is a vertex, and no not-a-number") {
  Recorder recorder(4);
  PathRecord record;
  record.has_vertex = record.shaded = true;
  record.unfiltered = Rgb(1, 0, 0);
  record.throughput = Rgb(0.5f, 1, 1);
  record.contribution = Rgb(2, 3, 4);
  recorder.set(0, 0, 1, record);
  record.has_vertex = false;
  recorder.set(1, 0, 2, record);
  record.unfiltered.y = std::numeric_limits<float>::quiet_NaN();
  recorder.set(2, 0, 1, record);
  film::Film film(3, 1);
  CHECK(recorder.add_to(film, 3, 1) == 1);
  CHECK(film.mean() == std::vector<float>{0, 0, 0, 2, 3, 4, 1, 0, 0});
  // Where one path in four is shaded only such paths count, with a vertex or without.
  record.unfiltered = Rgb(8, 8, 8);
  record.shaded = false;
  recorder.set(2, 0, 2, record);
  record.has_vertex = true;
  recorder.set(3, 0, 1, record);
  film::Film thinned(3, 1);
  CHECK(recorder.add_to(thinned, 4, 4) == 0);
  CHECK(thinned.mean() == std::vector<float>{0, 0, 0, 2, 3, 4, 1, 0, 0});
}

TEST_CASE("the recorder's channels are those of the format, of their type") {
  const std::vector<std::string> all{"all"};
  const std::vector<formats::Channel> channels = record_channels(all);
  CHECK(channels.size() == formats::kChannels.size());
  for (const formats::Channel& channel : channels) {
    INFO(channel.name);
    const formats::ChannelInfo* info = formats::channel_info(channel.name);
    REQUIRE(info != nullptr);
    CHECK(channel.type == info->type);
    CHECK(channel.components == info->components);
  }
}
