// A dump gives back what was written, and names what is wrong or missing.
#include "run/dump.h"

#include <array>
#include <set>

#include "catch.h"
#include "core/error.h"
#include "filter/channels.h"
#include "formats/layout/channels.h"
#include "temp_folder.h"
#include "write_dump.h"

namespace psf {
namespace {

using run::BlockRecords;
using run::Dump;
using tests::RecordSet;

const std::vector<filter::CameraView> kCameras = {{20, 10, 0.05}, {10, 20, 0.02}};

filter::Parameters all_terms() {
  filter::Parameters parameters;
  parameters.weights = {0.9f, 0.1f, true, 0.3f, 0.5f, 0.5f, true};
  return parameters;
}

template <typename T>
std::vector<T> part(const std::vector<T>& column, std::size_t first, std::size_t last) {
  return {column.begin() + static_cast<std::ptrdiff_t>(first),
          column.begin() + static_cast<std::ptrdiff_t>(last)};
}

TEST_CASE("Any range of records comes back as it was written") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(1000, 1, 0.2, kCameras);
  for (const auto codec : {formats::Codec::raw, formats::Codec::zstd}) {
    const std::string path = folder / (codec == formats::Codec::raw ? "raw.pvb" : "zstd.pvb");
    tests::DumpOptions options{kCameras, {400, 400, 200}, {}};
    options.codec = codec;
    tests::write_dump(path, set, options);
    const Dump dump(path);
    CHECK(dump.pixels() == 400);
    CHECK(dump.pass_bounds() == std::vector<std::uint64_t>{0, 400, 800, 1000});
    const run::ChannelSet channels = dump.select(all_terms(), true);
    BlockRecords block;
    for (const auto& [first, last] :
         {std::pair{0u, 1000u}, {399u, 401u}, {150u, 850u}, {999u, 1000u}, {5u, 5u}}) {
      dump.read({first, last}, channels, block);
      CHECK(block.position == part(set.position, first, last));
      CHECK(block.distance == part(set.distance, first, last));
      CHECK(block.throughput == part(set.throughput, first, last));
      CHECK(block.contribution == part(set.contribution, first, last));
      CHECK(block.unfiltered == part(set.unfiltered, first, last));
      CHECK(block.flags == part(set.flags, first, last));
      CHECK(block.pixel == part(set.pixel, first, last));
      CHECK(block.camera == part(set.camera, first, last));
      CHECK(block.normal == part(set.normal, first, last));
      CHECK(block.reflectance == part(set.reflectance, first, last));
      CHECK(block.visibility == part(set.visibility, first, last));
      CHECK(block.hit_distance == part(set.hit_distance, first, last));
      CHECK(block.direction == part(set.direction, first, last));
      CHECK(block.material == part(set.material, first, last));
    }
  }
}

TEST_CASE("Only what is needed is read, and what is optional has its default") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(200, 2, 0.2, {{20, 10, 0.05}});
  tests::write_dump(folder / "a.pvb", set,
                    {{{20, 10, 0.05}}, {200}, {"flags", "unfiltered", "camera", "normal"}});
  const Dump dump(folder / "a.pvb");
  filter::Parameters parameters;
  parameters.weights = filter::WeightTerms::none();
  parameters.radius.basis = filter::RadiusBasis::world;
  BlockRecords block;
  dump.read({0, 200}, dump.select(parameters, false), block);
  CHECK(block.flags == std::vector<std::uint8_t>(200, filter::kHasVertex | filter::kShaded));
  CHECK(block.unfiltered.empty());
  CHECK(block.camera.empty());
  CHECK(block.normal.empty());
  CHECK(block.reflectance.empty());
  CHECK(block.visibility.empty());
  CHECK(block.distance.empty());
  CHECK(dump.select(parameters, true).reflectance.has_value());
  CHECK_FALSE(dump.select(parameters, true).normal.has_value());
}

TEST_CASE("A missing channel is named with the option that needs it") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(400, 3, 0, kCameras);
  const auto message = [&](const std::string& channel,
                           const filter::Parameters& parameters) -> std::string {
    const std::string path = folder / (channel + ".pvb");
    tests::write_dump(path, set, {kCameras, {400}, {channel}});
    try {
      static_cast<void>(Dump(path).select(parameters, true));
      return "none";
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::bad_input);
      return std::string(error.what()).substr(path.size() - channel.size() - 4);
    }
  };
  const auto expected = [](const std::string& channel, const std::string& by,
                           const std::string& instead) {
    return channel + ".pvb: has no channel " + channel + ", which " + by +
           " needs; render a dump that has it" + (instead.empty() ? "" : ", or " + instead);
  };
  using Case = std::array<const char*, 3>;
  for (const auto& [channel, by, instead] :
       {Case{"visibility", "`visibility`", "give `visibility=off`"},
        Case{"hit_distance", "`hit-distance`", "give `hit-distance off`"},
        Case{"normal", "`normal`", "give `normal off`"},
        Case{"reflectance", "`reflectance`", "give `reflectance off`"},
        Case{"direction", "`direction`", "give `direction off`"},
        Case{"material", "`material`", "leave `material` out"}, Case{"position", "the filter", ""},
        Case{"contribution", "the filter", ""}, Case{"throughput", "the filter", ""},
        Case{"pixel", "the filter", ""}, Case{"camera", "a dump of several cameras", ""},
        Case{"distance", "a radius that depends on the distance", ""}}) {
    CHECK(message(channel, all_terms()) == expected(channel, by, instead));
  }
  filter::Parameters none;
  none.weights = filter::WeightTerms::none();
  CHECK(message("normal", none) == "none");
  none.demodulate = true;
  CHECK(message("reflectance", none) ==
        expected("reflectance", "`demodulate`", "leave `demodulate` out"));
}

TEST_CASE("A pixel or a camera that does not exist is an error with the record's number") {
  const tests::TempFolder folder;
  RecordSet set = tests::random_records(400, 4, 0, kCameras);
  set.pixel[123] = 200;
  tests::write_dump(folder / "pixel.pvb", set, {kCameras, {400}, {}});
  set.pixel[123] = 0;
  set.camera[321] = 2;
  tests::write_dump(folder / "camera.pvb", set, {kCameras, {400}, {}});
  BlockRecords block;
  const Dump pixel(folder / "pixel.pvb"), camera(folder / "camera.pvb");
  CHECK_THROWS_WITH(
      pixel.read({100, 400}, pixel.select({}, false), block),
      folder / "pixel.pvb" +
          ": record 123: pixel 200 is outside the 20 x 10 of camera \"camera 0\"; render it again");
  CHECK_NOTHROW(pixel.read({124, 400}, pixel.select({}, false), block));
  CHECK_THROWS_WITH(
      camera.read({0, 400}, camera.select({}, false), block),
      folder / "camera.pvb" +
          ": record 321: camera 2 does not exist, the metadata name 2; render it again");
}

TEST_CASE("A dump without camera or with an impossible one is refused") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(200, 5, 0, {{20, 10, 0.05}});
  tests::write_dump(folder / "none.pvb", set, {{}, {200}, {}});
  CHECK_THROWS_AS(Dump(folder / "none.pvb"), Error);
  tests::write_dump(folder / "empty.pvb", set, {{{0, 10, 0.05}}, {200}, {}});
  CHECK_THROWS_AS(Dump(folder / "empty.pvb"), Error);
  tests::write_dump(folder / "huge.pvb", set, {{{0xFFFFFFFF, 0xFFFFFFFF, 0.05}}, {200}, {}});
  CHECK_THROWS_AS(Dump(folder / "huge.pvb"), Error);
  CHECK_THROWS_AS(Dump(folder / "nowhere.pvb"), Error);
}

TEST_CASE(
    "every channel of the format but those is one of the filter, and its values fit the type") {
  std::set<std::string_view> others = {"film", "lens", "time", "frame"};
  filter::for_each_channel([&](std::string_view name, const auto& member) {
    INFO(name);
    const formats::ChannelInfo* channel = formats::channel_info(name);
    REQUIRE(channel != nullptr);
    using Value =
        typename std::decay_t<decltype(member(std::declval<BlockRecords&>()))>::value_type;
    CHECK(sizeof(Value) == channel->components * formats::size_of(channel->type));
    CHECK(std::is_integral_v<Value> == (channel->type != formats::Type::f32));
    CHECK(others.insert(name).second);
  });
  CHECK(others.size() == formats::kChannels.size());
}

}  // namespace
}  // namespace psf
