// concatenate(): what does not belong together is refused by name, and a failure leaves no output.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "catch.h"
#include "core/error.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/layout/metadata.h"
#include "formats/read/reader.h"
#include "formats/write/concatenate.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

struct Two {
  Two() {
    test::write_numbered_file(a, Codec::raw, 2);
    rewrite([](Head&) {});
  }
  // The second with another head.
  template <class Change>
  void rewrite(const Change& change) const {
    Head head = test::numbered_head();
    change(head);
    Writer writer(b, head, {Codec::zstd, false, {}});
    std::vector<test::Bytes> columns;
    std::vector<const void*> pointers;
    for (const Channel& channel : head.channels) columns.emplace_back(10 * channel.stride());
    for (const auto& column : columns) pointers.push_back(column.data());
    writer.append(10, pointers);
    writer.commit();
  }
  // The error of joining both; nothing may be written.
  [[nodiscard]] std::string refusal(ErrorCode code, const ConcatenateOptions& options = {}) const {
    std::string text;
    try {
      static_cast<void>(concatenate(std::vector{a, b}, out, options));
    } catch (const Error& error) {
      CHECK(error.code() == code);
      text = error.what();
    }
    CHECK(text.find('\n') == std::string::npos);
    CHECK_FALSE(std::filesystem::exists(out));
    CHECK_FALSE(std::filesystem::exists(out + ".partial"));
    return text;
  }
  [[nodiscard]] std::string with_metadata(const char* key, const nlohmann::json& value) const {
    rewrite([&](Head& head) {
      auto metadata = nlohmann::ordered_json::parse(head.metadata);
      metadata[key] = value;
      head.metadata = metadata.dump();
    });
    return refusal(ErrorCode::bad_input);
  }

  const test::WithoutSync fast;
  const test::Scratch scratch;
  const std::string a = scratch.path("a.pvb"), b = scratch.path("b.pvb"),
                    out = scratch.path("out.pvb");
};

}  // namespace

TEST_CASE("another scene, picture or schema is refused by name") {
  const Two two;
  const std::string scene = two.with_metadata("scene_hash", "beef");
  CHECK(scene.find(two.b) == 0);
  CHECK(test::has(scene, "its scene_hash is another: \"beef\", not \"5eed\""));
  CHECK(test::has(two.with_metadata("cameras", nlohmann::json::array()), "its cameras is another"));
  CHECK(test::has(two.with_metadata("integrator", "ao"), "its integrator is another"));
  CHECK(test::has(two.with_metadata("block_base", 3), "its block_base is another"));
  CHECK(test::has(two.with_metadata("units", "inch"), "its units is another"));
  CHECK(test::has(two.with_metadata("unheard.of", 1), "its unheard.of is another"));
  const auto schema = [&](const auto& change) {
    two.rewrite(change);
    return two.refusal(ErrorCode::bad_input);
  };
  CHECK(test::has(schema([](Head& h) { h.channels.pop_back(); }),
                  "as number 9 none, not noise u64 x 1"));
  CHECK(test::has(schema([](Head& h) {
                    h.channels.push_back({"more", Type::u8, 1});
                  }),
                  "as number 10 more u8 x 1, not none"));
  CHECK(test::has(schema([](Head& h) { h.channels[3].type = Type::f16; }),
                  "reflectance f16 x 3, not"));
  CHECK(test::has(schema([](Head& h) { h.minor = 1; }), "another version"));
  CHECK(test::has(schema([](Head& h) { h.optional_features = 1; }), "another version"));
  CHECK(test::has(schema([](Head& h) { h.later_bytes.resize(3); }), "another version"));
}

TEST_CASE("paths may be of another seed or sampler; the same ones twice are noted") {
  const Two two;
  two.rewrite([](Head& head) {
    auto metadata = nlohmann::ordered_json::parse(head.metadata);
    metadata["seed"] = 77;
    metadata["sampler"] = "halton";
    head.metadata = metadata.dump();
  });
  CHECK(concatenate(std::vector{two.a, two.b}, two.out).notes.empty());
  CHECK(Reader(two.out).records() == 90);
  const auto same_file = concatenate(std::vector{two.a, two.a}, two.out);
  REQUIRE(same_file.notes.size() == 1);
  CHECK(test::has(same_file.notes[0], "uuid comes twice"));
  two.rewrite([](Head&) {});
  const auto same_seed = concatenate(std::vector{two.a, two.b}, two.out);
  REQUIRE(same_seed.notes.size() == 1);
  CHECK(test::has(same_seed.notes[0], "seed 0 comes twice"));
}

TEST_CASE("files of other material names are refused, names that only one tells are kept") {
  const Two two;
  const auto rewrite = [&](const char* names) {
    two.rewrite([&](Head& head) {
      auto metadata = nlohmann::ordered_json::parse(head.metadata);
      metadata["materials"] = nlohmann::ordered_json::parse(names);
      head.metadata = metadata.dump();
    });
  };
  rewrite(R"(["wall", "floor"])");
  for (const auto& inputs : {std::vector{two.a, two.b}, std::vector{two.b, two.a}}) {
    static_cast<void>(concatenate(inputs, two.out));
    CHECK(parse_metadata(Reader(two.out).head().metadata).materials ==
          std::vector<std::string>{"wall", "floor"});
  }
  std::filesystem::remove(two.out);
  std::filesystem::rename(two.b, two.a);
  rewrite(R"(["floor", "wall"])");
  CHECK(test::has(two.refusal(ErrorCode::bad_input),
                  R"(its materials is another: ["floor","wall"], not ["wall","floor"])"));
}

TEST_CASE("channels and passes that there are not are refused by name") {
  const Two two;
  const auto with = [&](const auto& change, ErrorCode code = ErrorCode::usage) {
    ConcatenateOptions options;
    change(options);
    return two.refusal(code, options);
  };
  const ErrorCode lacking = ErrorCode::bad_input;
  CHECK(test::has(with([](auto& o) { o.drop = {"motion"}; }, lacking),
                  "has no channel motion; it has number, "));
  CHECK(
      test::has(with([](auto& o) { o.channels = {"motion"}; }, lacking), "has no channel motion"));
  CHECK(
      test::has(with([](auto& o) { o.quantize = {"motion"}; }, lacking), "has no channel motion"));
  CHECK(test::has(with([](auto& o) { o.quantize = {"pixel"}; }), "channel pixel is u32"));
  CHECK(test::has(with([](auto& o) { o.drop = {"position"}; }),
                  "channel position cannot be dropped"));
  CHECK(test::has(with([](auto& o) { o.last_pass = 4; }), "passes 0:4 are no part of the 3"));
  CHECK(test::has(with([](auto& o) { o.first_pass = 3; }), "passes 3:3"));
  CHECK(test::has(with([](auto& o) { o.last_pass = 0; }), "passes 0:0"));
}

TEST_CASE("a damaged column is named, and the rest can be had without it") {
  const Two two;
  const test::Bytes whole = test::load(two.a);
  for (const bool decode : {false, true}) {
    test::Bytes bytes = whole;
    const std::size_t chunk = test::frames(whole, "CHNK").at(1).offset;
    bytes.at(chunk + test::get(whole, chunk + 96 + 24 * 3 + 8, 8)) ^= std::byte{1};
    test::save(two.a, bytes);
    ConcatenateOptions options;
    if (decode) options.codec = Codec::zstd;
    const std::string text = two.refusal(ErrorCode::bad_input, options);
    CHECK(text.find(two.a) == 0);
    CHECK(test::has(text, "chunk 1 (records 16-31)"));
    CHECK(test::has(text, "channel reflectance"));
    options.drop = {"reflectance"};
    CHECK(concatenate(std::vector{two.a, two.b}, two.out, options).records == 90);
    CHECK(check(two.out).faults.empty());
    std::filesystem::remove(two.out);
  }
  CHECK_THROWS_AS(concatenate(std::vector{two.a, two.scratch.path("none.pvb")}, two.out), Error);
}

TEST_CASE("an input under the temporary name of the output is not overwritten") {
  const Two two;
  const std::string partial = two.out + ".partial";
  std::filesystem::copy_file(two.a, partial);
  const test::Bytes whole = test::load(partial);
  CHECK_THROWS_AS(concatenate(std::vector{partial}, two.out), Error);
  CHECK(test::load(partial) == whole);
}

TEST_CASE("whichever write, sync, rename or close of concatenate() fails, no output is left") {
  const test::Scratch scratch;
  const std::string a = scratch.path("a.pvb"), out = scratch.path("out.pvb");
  test::write_numbered_file(a, Codec::raw, 3);
  const test::Bytes whole = test::load(a);
  int cases = 0;
  for (const bool over_input : {false, true}) {
    const std::string to = over_input ? a : out;
    std::optional<ErrorCode> code;
    const auto work = [&] {
      std::filesystem::remove(out);
      test::save(a, whole);
      code.reset();
      try {
        static_cast<void>(concatenate(std::vector{a}, to));
      } catch (const Error& error) {
        code = error.code();
      }
    };
    int replaced = 0, silent = 0, closes = 0;
    cases += test::fail_each(work, [&](int n) {
      CAPTURE(over_input, n);
      if (code) CHECK(code == ErrorCode::io);
      if (code && test::calls().failed == std::string("close")) ++closes;
      CHECK_FALSE(std::filesystem::exists(to + ".partial"));
      // Only the folder's sync comes when the output has its name, and the last close, behind one
      // that told that all is kept.
      if (!code) ++silent;
      const bool there = over_input ? test::load(a) != whole : std::filesystem::exists(out);
      replaced += there;
      if (there || over_input) CHECK(test::holds_passes(Reader(to), 3));
    });
    CHECK(replaced == 2);
    CHECK(silent == 1);
    CHECK(closes == 1);  // before the rename
  }
  CAPTURE(cases);
  CHECK(cases > 30);
}
