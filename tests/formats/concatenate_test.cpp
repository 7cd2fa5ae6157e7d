// concatenate(): files joined, converted and thinned out hold the values of their parts.
#include "formats/write/concatenate.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "catch.h"
#include "core/error.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

// Passes of the numbered records from `first` on, renumbered as a file of its own.
void write_part(const std::string& path, Codec codec, std::uint64_t first, std::uint64_t passes,
                std::uint64_t seed = 0) {
  Head head = test::numbered_head();
  auto metadata = nlohmann::ordered_json::parse(head.metadata);
  metadata["seed"] = seed;
  metadata["studio.shot"] = {{"take", 3}};
  head.metadata = metadata.dump();
  Writer writer(path, head, {codec, false, {}});
  for (std::uint64_t pass = first; pass < first + passes; ++pass) {
    test::append_numbered(writer, pass * test::kNumberedPass, test::kNumberedPass);
    const std::string state = test::numbered_state(pass + 1);
    writer.commit(std::as_bytes(std::span(state)));
  }
}

struct Parts {
  Parts() {
    write_part(a, Codec::raw, 0, 2, 1);
    write_part(b, Codec::zstd, 2, 3, 2);
    write_part(c, Codec::raw, 5, 1, 3);
  }
  const test::WithoutSync fast;
  const test::Scratch scratch;
  const std::string a = scratch.path("a.pvb"), b = scratch.path("b.pvb"), c = scratch.path("c.pvb"),
                    out = scratch.path("out.pvb");
};

ConcatenateResult join(const std::vector<std::string>& inputs, const std::string& out,
                       const ConcatenateOptions& options = {}) {
  const ConcatenateResult report = concatenate(inputs, out, options);
  CHECK(check(out).faults.empty());
  const Reader reader(out);
  CHECK(reader.closed());
  CHECK(report.records == reader.records());
  CHECK(report.passes == reader.passes().size());
  CHECK(report.bytes == reader.file_bytes());
  CHECK_FALSE(std::filesystem::exists(out + ".partial"));
  return report;
}

std::vector<float> floats(const Reader& reader, const std::string& channel) {
  const std::size_t k = reader.require(channel, "the test");
  std::vector<float> out(reader.records() * reader.head().channels[k].decoded_components());
  reader.read_floats(k, 0, reader.records(), out);
  return out;
}

}  // namespace

TEST_CASE("joined files are their parts one behind the other") {
  const Parts parts;
  const ConcatenateResult report = join({parts.a, parts.b, parts.c}, parts.out);
  CHECK(report.overflows == 0);
  CHECK(report.notes.empty());
  const Reader reader(parts.out);
  CHECK(test::holds_passes(reader, 6));
  CHECK(reader.resume_state().empty());
  // Stored as they were: raw stays raw, compressed stays compressed.
  const Reader b(parts.b);
  CHECK(reader.columns(0)[1].codec == Codec::raw);
  CHECK(reader.columns(6)[7].codec == b.columns(0)[7].codec);
  CHECK(b.columns(0)[7].codec == Codec::zstd);

  const auto metadata = nlohmann::json::parse(reader.head().metadata);
  CHECK(metadata["seed"] == 1);
  CHECK(metadata["studio.shot"]["take"] == 3);
  const auto& joined = metadata["joined"];
  REQUIRE(joined.size() == 3);
  CHECK(joined[0]["uuid"] == Reader(parts.a).uuid());
  CHECK(joined[1]["uuid"] == b.uuid());
  CHECK(joined[1]["passes"] == 3);
  CHECK(joined[2]["seed"] == 3);
  CHECK(joined[2]["producer"] == "numbered");

  // What was joined can be joined again.
  static_cast<void>(join({parts.out}, parts.out));
  CHECK(test::holds_passes(Reader(parts.out), 6));
}

TEST_CASE("any range of passes is that part of the whole") {
  const Parts parts;
  std::size_t cases = 0;
  for (std::uint64_t first = 0; first < 6; ++first) {
    for (std::uint64_t last = first + 1; last <= 6; ++last) {
      ConcatenateOptions options;
      options.first_pass = first;
      options.last_pass = last;
      static_cast<void>(join({parts.a, parts.b, parts.c}, parts.out, options));
      const Reader reader(parts.out);
      CHECK(reader.passes().size() == last - first);
      CHECK(test::numbers_of(reader) ==
            test::numbers_from(first * test::kNumberedPass, (last - first) * test::kNumberedPass));
      CHECK(test::wrong_columns(reader) == 0);
      ++cases;
    }
  }
  CHECK(cases == 21);
}

TEST_CASE("a change of codec changes no value") {
  const Parts parts;
  std::uintmax_t bytes = 0;
  for (const Codec codec : {Codec::zstd, Codec::raw, Codec::zstd}) {
    ConcatenateOptions options;
    options.codec = codec;
    static_cast<void>(join({bytes == 0 ? parts.b : parts.out}, parts.out, options));
    const Reader reader(parts.out);
    CHECK(test::wrong_columns(reader) == 0);
    std::size_t raw = 0;
    for (std::size_t chunk = 0; chunk < reader.chunks().size(); ++chunk) {
      for (const Column& column : reader.columns(chunk)) raw += column.codec == Codec::raw;
    }
    CHECK((raw == reader.chunks().size() * reader.head().channels.size()) == (codec == Codec::raw));
    bytes = std::filesystem::file_size(parts.out);
  }
}

TEST_CASE("channels are dropped or kept, and the others are as they were") {
  const Parts parts;
  ConcatenateOptions drop;
  drop.drop = {"noise", "normal"};
  static_cast<void>(join({parts.a, parts.b}, parts.out, drop));
  ConcatenateOptions keep;
  keep.channels = {"number", "flags"};
  static_cast<void>(join({parts.a, parts.b}, parts.out + "2", keep));
  const Head all = test::numbered_head();
  const auto check_kept = [&](const std::string& path, const std::vector<std::string>& gone) {
    const Reader reader(path);
    CHECK(reader.head().channels.size() == all.channels.size() - gone.size());
    for (const std::string& name : gone) CHECK_FALSE(reader.head().find(name));
    for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
      const std::size_t from = *all.find(reader.head().channels[k].name);
      const bool same = test::read_all(reader, k) ==
                        test::numbered_values(from, test::numbers_from(0, reader.records()));
      CHECK(same);
    }
  };
  check_kept(parts.out, {"noise", "normal"});
  check_kept(parts.out + "2", {"noise", "normal", "reflectance"});  // the others are required
}

TEST_CASE("quantised channels are declared and as close as the format promises") {
  const Parts parts;
  ConcatenateOptions options;
  options.quantize = {"normal", "reflectance", "contribution"};
  options.codec = Codec::zstd;
  static_cast<void>(join({parts.a, parts.b}, parts.out, options));
  const Reader reader(parts.out);
  const Head& head = reader.head();
  CHECK(head.channels[2] == Channel{"normal", Type::u16, 2, Encoding::octahedral});
  CHECK(head.channels[3] == Channel{"reflectance", Type::f16, 3, Encoding::plain});
  CHECK(head.channels[1] == test::numbered_head().channels[1]);
  const auto numbers = test::numbers_from(0, reader.records());
  const auto exact = [&](std::size_t channel) {
    const auto bytes = test::numbered_values(channel, numbers);
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  };
  const std::vector<float> normals = exact(2), got = floats(reader, "normal");
  double worst = 0;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    // The length of the cross product is the sine, without the cosine's loss near 0.
    const float *a = &normals[3 * k], *b = &got[3 * k];
    const auto part = [&](std::size_t i, std::size_t j) {
      return double{a[i]} * double{b[j]} - double{a[j]} * double{b[i]};
    };
    const double sine = std::hypot(part(0, 1), part(1, 2), part(2, 0));
    worst = std::max(worst, std::asin(std::min(1.0, sine)) * 180 / 3.14159265358979);
  }
  CHECK(worst < 0.004);
  CHECK(worst > 0);
  for (const std::size_t channel : {std::size_t{3}, std::size_t{5}}) {
    const std::vector<float> from = exact(channel),
                             to = floats(reader, head.channels[channel].name);
    REQUIRE(from.size() == to.size());
    std::size_t wrong = 0, nan = 0;
    for (std::size_t k = 0; k < from.size(); ++k) {
      if (std::isnan(from[k])) {
        ++nan;
        wrong += !std::isnan(to[k]);
        continue;
      }
      // Half a unit in the last of 11 bits, or of the smallest subnormal.
      const float ulp = std::ldexp(1.0f, std::max(std::ilogb(from[k]), -14) - 10);
      wrong += !(std::abs(from[k] - to[k]) <= ulp / 2);
    }
    CHECK(wrong == 0);
    CHECK((nan > 0) == (channel == 5));
  }
  // Again, it is quantised already.
  options.codec.reset();
  static_cast<void>(join({parts.out}, parts.out + "2", options));
  const bool same = test::read_all(Reader(parts.out + "2"), 2) == test::read_all(reader, 2);
  CHECK(same);
}

TEST_CASE("what is too large for f16 is counted") {
  const Parts parts;
  Head head;
  head.channels = {{"hit_distance", Type::f32, 1}};
  const std::array<float, 6> values = {
      65504.0f, 65519.0f, 65520.0f, -1e30f, std::numeric_limits<float>::infinity(), NAN};
  {
    Writer writer(parts.out, head, {Codec::raw, false, {}});
    const std::array<const void*, 1> columns = {values.data()};
    writer.append(values.size(), columns);
    writer.commit();
  }
  ConcatenateOptions options;
  options.quantize = {"hit_distance"};
  CHECK(join({parts.out}, parts.out, options).overflows == 2);
  const auto got = floats(Reader(parts.out), "hit_distance");
  CHECK(got[0] == 65504.0f);
  CHECK(got[1] == 65504.0f);
  CHECK(std::isinf(got[2]));
  CHECK(got[3] == -std::numeric_limits<float>::infinity());
}

TEST_CASE("what a later version declares is kept") {
  const Parts parts;
  Head later = test::numbered_head();
  later.minor = 3;
  later.optional_features = 0x40;
  later.later_bytes = {std::byte{1}, std::byte{2}, std::byte{3}};
  later.later_fields[7] = std::byte{9};
  later.metadata = R"({"new key":[1,2,{"deep":null}],"seed":18446744073709551615})";
  {
    Writer writer(parts.a, later, {Codec::raw, false, {}});
    test::write_numbered(writer, 2);
  }
  ConcatenateOptions options;
  options.drop = {"noise"};
  static_cast<void>(join({parts.a}, parts.out, options));
  const Head head = Reader(parts.out).head();
  CHECK(head.minor == 3);
  CHECK(head.optional_features == 0x40);
  CHECK(head.later_bytes == later.later_bytes);
  CHECK(head.later_fields == later.later_fields);
  CHECK(head.metadata == later.metadata);
}

TEST_CASE("one whole input keeps its resume state and goes on") {
  const Parts parts;
  ConcatenateOptions options;
  options.codec = Codec::zstd;
  static_cast<void>(join({parts.a}, parts.a, options));  // the output is the input
  Writer writer = Writer::resume(parts.a, test::numbered_head(), {Codec::raw, false, {}});
  const auto state = writer.resume_state();
  CHECK(std::string(reinterpret_cast<const char*>(state.data()), state.size()) ==
        test::numbered_state(2));
  test::write_numbered(writer, 4);
  writer.close();
  CHECK(test::holds_passes(Reader(parts.a), 4));
  // A part of it does not.
  options.last_pass = 3;
  static_cast<void>(join({parts.a}, parts.out, options));
  CHECK(Reader(parts.out).resume_state().empty());
}

TEST_CASE("the same command gives the same values, and an uncommitted tail is left out") {
  const Parts parts;
  test::Bytes tail;
  {
    Writer writer = Writer::resume(parts.a, test::numbered_head(), {Codec::raw, false, {}});
    test::append_numbered(writer, 80, 32);
    tail = test::load(parts.a);
  }
  test::save(parts.a, tail);
  static_cast<void>(join({parts.a, parts.b}, parts.out));
  CHECK(test::holds_passes(Reader(parts.out), 5));
}
