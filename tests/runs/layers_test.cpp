// Layers of the light from a dump to its pictures: what they are called, and that they add up.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "catch.h"
#include "core/error.h"
#include "filter/memory.h"
#include "filter_dump_setup.h"
#include "run/light_layers.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share
using Names = std::vector<std::string>;

// A dump of 600 records whose c and u have the layers `key`, `fill` (of c alone) and `seen` (of u
// alone).
class Layered {
 public:
  explicit Layered(std::uint32_t seed) : set_(random_records(600, seed, 0, kTwo)) {
    for (std::size_t i = 0; i < set_.size(); ++i) {
      const Rgb &c = set_.contribution[i], &u = set_.unfiltered[i];
      const float share = i % 3 == 0 ? 0.25f : 1;
      key_.push_back(c * share);
      fill_.push_back(c - c * share);
      key_u_.push_back(Rgb(u.x, 0, 0));
      seen_.push_back(Rgb(0, u.y, u.z));
    }
    options_ = {kTwo, {200, 200, 200}, {}};
    options_.more = {{"contribution.key", &key_},
                     {"unfiltered.seen", &seen_},
                     {"contribution.fill", &fill_},
                     {"unfiltered.key", &key_u_}};
  }
  [[nodiscard]] std::string written() const {
    write_dump(folder_ / "a.pvb", set_, options_);
    return folder_ / "a.pvb";
  }
  RecordSet set_;
  DumpOptions options_;
  std::vector<Rgb> key_, fill_, key_u_, seen_;

 private:
  TempFolder folder_;
};

// The largest difference between the colours behind `prefix` and the sum of the layers', relative
// to what is added up.
double off_their_sum(const film::Image& image, const std::string& prefix, const Names& layers) {
  const std::vector<Rgb> all = image.rgb(prefix);
  double largest = 0;
  for (std::size_t pixel = 0; pixel < all.size(); ++pixel) {
    for (int c = 0; c < 3; ++c) {
      double sum = 0, size = 1e-20;
      for (const std::string& layer : layers) {
        const double value = double{image.rgb(prefix + layer + ".")[pixel][c]};
        sum += value;
        size += std::abs(value);
      }
      largest = std::max(largest, std::abs(sum - double{all[pixel][c]}) / size);
    }
  }
  return largest;
}

Names names_of(const std::vector<run::LightLayer>& layers) {
  Names names;
  for (const run::LightLayer& layer : layers) names.push_back(layer.name);
  return names;
}

TEST_CASE("The layers of a dump are in its pictures, and add up to them") {
  const Layered dump(51);
  const std::string path = dump.written();
  for (const char* estimator : {"average", "hash", "adaptive"}) {
    FilterRequest request = default_run();
    filter::set_parameter(request.parameters, "estimator", estimator);
    for (const film::Image& image : filtered(path, request)) {
      INFO(estimator);
      CHECK(off_their_sum(image, "", {"key", "seen", "fill"}) <= 1e-6);
      CHECK(off_their_sum(image, "unfiltered-input.", {"key", "seen", "fill"}) <= 1e-6);
      CHECK(image.attributes == decltype(image.attributes){{"psf:light-layers", "key,seen,fill"}});
    }
  }
}

TEST_CASE("With layers the other channels are what they are without, bit for bit") {
  const Layered dump(52);
  const std::string path = dump.written();
  FilterRequest request = default_run();
  const std::vector<film::Image> all = filtered(path, request);
  request.layers.light = Names{};
  const std::vector<film::Image> none = filtered(path, request);
  request.layers.light = Names{"fill"};
  const std::vector<film::Image> some = filtered(path, request);
  for (std::size_t camera = 0; camera < all.size(); ++camera) {
    CHECK(none[camera].attributes.empty());
    CHECK(all[camera].layers.size() == none[camera].layers.size() + 18);
    CHECK(some[camera].layers.size() == none[camera].layers.size() + 6);
    for (const film::Layer& layer : none[camera].layers) {
      CHECK(*all[camera].find(layer.channel) == layer.values);
    }
    for (const film::Layer& layer : some[camera].layers) {
      CHECK(*all[camera].find(layer.channel) == layer.values);
    }
  }
}

TEST_CASE("A layer is the picture of a dump that has its light alone") {
  Layered dump(53);
  const FilterRequest request = default_run();
  const std::vector<film::Image> layered = filtered(dump.written(), request);
  dump.set_.contribution = dump.key_;
  dump.set_.unfiltered = dump.key_u_;
  dump.options_.more.clear();
  const std::vector<film::Image> alone = filtered(dump.written(), request);
  for (std::size_t camera = 0; camera < alone.size(); ++camera) {
    CHECK(layered[camera].rgb("key.") == alone[camera].rgb());
    CHECK(layered[camera].rgb("unfiltered-input.key.") == alone[camera].rgb("unfiltered-input."));
  }
}

TEST_CASE("A layer that is black in some chunks, blocks or columns is that of its light alone") {
  for (const formats::Codec codec : {formats::Codec::raw, formats::Codec::zstd}) {
    for (const std::uint32_t capacity : {100u, 200u}) {
      Layered dump(60);
      dump.options_.codec = codec;
      dump.options_.chunk_capacity = capacity;
      // The first pass is black, the second but for its last record; of u all are.
      std::fill_n(dump.key_.begin(), 399, Rgb(0, 0, 0));
      dump.key_[399] = Rgb(0, 0, 0.5f);
      dump.key_u_.assign(dump.set_.size(), Rgb(0, 0, 0));
      for (const char* block : {"1pass", "2passes", "2^7"}) {
        INFO(capacity << " a chunk, block " << block);
        const FilterRequest request = default_run(block);
        const std::vector<film::Image> layered = filtered(dump.written(), request);
        Layered bare(60);
        bare.set_.contribution = dump.key_;
        bare.set_.unfiltered = dump.key_u_;
        bare.options_.more.clear();
        const std::vector<film::Image> alone = filtered(bare.written(), request);
        for (std::size_t camera = 0; camera < alone.size(); ++camera) {
          CHECK(layered[camera].rgb("key.") == alone[camera].rgb());
          CHECK(layered[camera].rgb("unfiltered-input.key.") ==
                alone[camera].rgb("unfiltered-input."));
          CHECK(layered[camera].rgb("key.") != layered[camera].rgb("fill."));
        }
      }
    }
  }
}

TEST_CASE("Columns of black layers are empty, and what is not finite in others is counted") {
  for (const formats::Codec codec : {formats::Codec::raw, formats::Codec::zstd}) {
    Layered dump(61);
    dump.options_.codec = codec;
    dump.options_.chunk_capacity = 200;
    dump.key_.assign(dump.set_.size(), Rgb(0, 0, 0));
    dump.seen_.assign(dump.set_.size(), Rgb(0, 0, 0));
    dump.seen_[250].y = -0.0f;
    dump.fill_[130].x = kNan;
    dump.fill_[599].z = -kInfinity;
    const run::Dump file(dump.written());
    run::ChannelSet channels = file.select(default_run().parameters, false);
    channels.layers = run::light_layers(file.reader());
    run::BlockRecords records;
    for (const filter::PathRange& range :
         {filter::PathRange{0, 600}, filter::PathRange{120, 240}, filter::PathRange{150, 190}}) {
      file.read(range, channels, records);
      const auto layers = records.view().layers;
      CHECK(layers[0].contribution.empty());
      CHECK(layers[1].contribution.empty());
      CHECK(layers[1].unfiltered.size() == (range.last > 250 ? 600u : 0u));
      CHECK(layers[2].contribution.size() == range.size());
      CHECK(records.layers[2].contribution.not_finite == (range.last == 600    ? 2u
                                                          : range.first <= 130 ? 1u
                                                                               : 0u));
      for (std::size_t i = 0; i < layers[2].contribution.size(); ++i) {
        const std::size_t of_file = static_cast<std::size_t>(range.first) + i;
        const bool damaged = of_file == 130 || of_file == 599;
        CHECK(layers[2].contribution[i] == (damaged ? Rgb(0, 0, 0) : dump.fill_[of_file]));
      }
    }
  }
}

TEST_CASE("Layers add up where paths are not shaded, and where a path overflows") {
  Layered dump(54);
  for (std::size_t i = 0; i < dump.set_.size(); i += 2) dump.set_.flags[i] &= filter::kHasVertex;
  dump.fill_[21] = Rgb(3e38f);
  dump.set_.contribution[21] = dump.key_[21] + dump.fill_[21];
  dump.set_.throughput[21] = Rgb(100);
  FilterRequest request = default_run();
  for (const char* r0 : {"0.25", "0"}) {
    filter::set_parameter(request.parameters, "r0", r0);
    for (const film::Image& image : filtered(dump.written(), request)) {
      CHECK(off_their_sum(image, "", {"key", "seen", "fill"}) <= 1e-6);
      CHECK(off_their_sum(image, "unfiltered-input.", {"key", "seen", "fill"}) <= 1e-6);
    }
  }
}

TEST_CASE("What of a layer is not finite counts as 0, is told, and has no say in the picture") {
  Layered dump(59);
  FilterRequest request = default_run();
  const std::vector<film::Image> whole = filtered(dump.written(), request);
  std::size_t damaged = 0;
  for (std::size_t i = 0; i < dump.set_.size(); i += 10, ++damaged) {
    dump.key_[i].x = i % 20 == 0 ? kNan : kInfinity;
  }
  dump.seen_[5].y = -kInfinity;
  const std::string path = dump.written();
  const run::FilterResult result = run::filter_dump(run::Dump(path), request);
  CHECK(result.not_finite_in_layers == damaged + 1);
  CHECK(result.statistics.left_out == 0);
  const std::vector<film::Image> pictures = images(result.pictures);
  for (std::size_t camera = 0; camera < pictures.size(); ++camera) {
    CHECK(pictures[camera].rgb() == whole[camera].rgb());
    CHECK(pictures[camera].rgb("fill.") == whole[camera].rgb("fill."));
    CHECK(pictures[camera].rgb("key.") != whole[camera].rgb("key."));
    for (const Rgb& color : pictures[camera].rgb("key.")) CHECK(is_finite(color));
  }
}

TEST_CASE("Layers are found by the names of channels, and asked for by theirs") {
  const Layered dump(55);
  const formats::Reader reader(dump.written());
  CHECK(names_of(run::light_layers(reader)) == Names{"key", "seen", "fill"});
  CHECK(names_of(run::light_layers(reader, Names{"fill", "key"})) == Names{"fill", "key"});
  CHECK(run::light_layers(reader, Names{}).empty());
  CHECK_FALSE(run::light_layers(reader)[1].contribution.has_value());
  CHECK_FALSE(run::light_layers(reader)[2].unfiltered.has_value());
  try {
    static_cast<void>(run::light_layers(reader, Names{"moon"}));
    FAIL("a layer that is not there");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::bad_input);
    CHECK(std::string(error.what()).find("no layer moon of the light; there are key, seen, fill") !=
          std::string::npos);
  }
}

TEST_CASE(
    "A channel that looks like a layer and is none is an error, unless layers are not asked") {
  for (const auto& [channel, part] :
       {std::pair("contribution.albedo", "albedo is another layer of pictures"),
        std::pair("unfiltered.a,b", "no ','"), std::pair("contribution.a=b", "no '='"),
        std::pair("contribution.none", "none stands for layers"),
        std::pair("unfiltered.unfiltered-input.x", "unfiltered-input.x is another layer"),
        std::pair("contribution.t", "it is f32 x 1, and layers of the light are f32 x 3")}) {
    Layered dump(56);
    dump.options_.more = {{channel, &dump.key_}};
    dump.options_.components_of_more = std::string(channel) == "contribution.t" ? 1 : 3;
    const std::string path = dump.written();
    const formats::Reader reader(path);
    try {
      static_cast<void>(run::light_layers(reader));
      FAIL(channel);
    } catch (const Error& error) {
      const std::string text = error.what();
      CHECK(text.find(channel) != std::string::npos);
      CHECK(text.find(part) != std::string::npos);
      CHECK(text.find("psf cat --drop " + std::string(channel)) != std::string::npos);
    }
    CHECK(run::light_layers(reader, Names{}).empty());
    FilterRequest request = default_run();
    request.layers = run::PictureLayers::none();
    CHECK(filtered(path, request).size() == 2);
  }
  Layered dump(57);
  dump.options_.more = {{"contribution.", &dump.key_}, {"contributions.key", &dump.key_}};
  CHECK(run::light_layers(formats::Reader(dump.written())).empty());
}

TEST_CASE("The memory of layers is in the estimate") {
  const Layered dump(58);
  const std::string path = dump.written();
  FilterRequest request = default_run();
  const run::MemoryEstimate all = run::filter_dump(run::Dump(path), request).memory;
  request.layers.light = Names{};
  const run::MemoryEstimate none = run::filter_dump(run::Dump(path), request).memory;
  CHECK(all.block == none.block + 200 * 4 * sizeof(Rgb));
  CHECK(all.filter == none.filter + 200 * 2 * filter::memory_per_layer(request.parameters));
  CHECK(all.pictures - none.pictures ==
        200 * 3 *
            (run::CameraPictures::kBytesOfSumsALayer + run::CameraPictures::kBytesToWriteALayer));
}

}  // namespace
}  // namespace psf
