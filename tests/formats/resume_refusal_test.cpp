// What must not be continued is refused and stays as it is, byte for byte.
#include <filesystem>
#include <optional>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/layout/file.h"
#include "formats/layout/metadata.h"
#include "formats/read/reader.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

// What resume() says; the file must be as it was.
std::string refusal(const std::string& path, const Head& head, ErrorCode expected) {
  const test::Bytes before = test::load(path);
  std::string text;
  try {
    const Writer writer = Writer::resume(path, head);
  } catch (const Error& error) {
    CHECK(error.code() == expected);
    text = error.what();
  }
  CHECK(text.find(path) == 0);
  CHECK(text.find('\n') == std::string::npos);
  const bool same = test::load(path) == before;
  CHECK(same);
  return text;
}

}  // namespace

TEST_CASE("another schema or scene is refused, and the file is unchanged") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  test::write_numbered_file(path, Codec::zstd, 2);
  const Head good = test::numbered_head();
  const auto said = [&](const auto& change) {
    Head head = good;
    change(head);
    return refusal(path, head, ErrorCode::bad_input);
  };
  CHECK(test::has(said([](Head& h) { h.channels.pop_back(); }),
                  "as number 9 noise u64 x 1, not nothing"));
  CHECK(test::has(said([](Head& h) {
                    h.channels.push_back({"more", Type::u8, 1});
                  }),
                  "not more u8 x 1"));
  CHECK(test::has(said([](Head& h) { h.channels[1].name = "place"; }), "not place f32 x 3"));
  CHECK(test::has(said([](Head& h) { h.channels[1].type = Type::f64; }), "not position f64 x 3"));
  CHECK(test::has(said([](Head& h) { h.channels[1].components = 4; }), "not position f32 x 4"));
  CHECK(test::has(said([](Head& h) { std::swap(h.channels[1], h.channels[2]); }), "as number 1"));
  CHECK(test::has(said([](Head& h) {
                    Metadata metadata = parse_metadata(h.metadata);
                    metadata.scene_hash = "beef";
                    h.metadata = to_json(metadata);
                  }),
                  "its scene_hash is '5eed', not 'beef'"));
  CHECK(said([](Head& h) { h.metadata = "no JSON"; }) != "");
  // The seed, the producer and the chunk capacity may be others: those of the file stay.
  Head other = good;
  Metadata metadata = parse_metadata(other.metadata);
  metadata.producer = "later";
  other.metadata = to_json(metadata);
  other.chunk_capacity = 1000;
  const Writer writer = Writer::resume(path, other);
  CHECK(writer.head().metadata == good.metadata);
  CHECK(writer.head().chunk_capacity == good.chunk_capacity);
}

TEST_CASE("a file of a later minor version is read but not continued") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  Head later = test::numbered_head();
  for (const bool bits : {false, true}) {
    later.minor = bits ? 0 : 2;
    later.optional_features = bits ? 4 : 0;
    {
      Writer writer(path, later, {Codec::raw, false, {}});
      test::write_numbered(writer, 2);
    }
    CHECK(test::holds_passes(Reader(path), 2));
    const std::string text = refusal(path, test::numbered_head(), ErrorCode::bad_input);
    CHECK(test::has(text, bits ? "version 1.0" : "version 1.2"));
  }
}

TEST_CASE("a damaged file is not continued") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  test::write_numbered_file(path, Codec::raw, 3);
  const test::Bytes whole = test::load(path);
  const auto damaged = [&](std::size_t place) {
    test::Bytes bytes = whole;
    bytes.at(place) ^= std::byte{4};
    test::save(path, bytes);
    return refusal(path, test::numbered_head(), ErrorCode::bad_input);
  };
  CHECK(damaged(5) != "");
  CHECK(damaged(100) != "");
  const std::size_t last = test::frames(whole, "CMIT").back().offset;
  CHECK(test::has(damaged(last + 70), "damaged"));
  // Its resume state alone: nothing could be told to the producer.
  CHECK(test::has(damaged(last + test::get(whole, last + 184, 8)), "resume state"));
  test::save(path, {});
  CHECK(refusal(path, test::numbered_head(), ErrorCode::bad_input) != "");
  test::save(path, test::Bytes(5000, std::byte{'x'}));
  CHECK(refusal(path, test::numbered_head(), ErrorCode::bad_input) != "");
  std::filesystem::remove(path);
  CHECK_THROWS_AS(Writer::resume(path, test::numbered_head()), Error);
  CHECK_FALSE(std::filesystem::exists(path));
  CHECK_THROWS_AS(Writer::resume("/dev/null", test::numbered_head()), Error);
}

TEST_CASE("of two writers one is refused, and the file is that of the other") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  test::write_numbered_file(path, Codec::raw, 1);
  {
    // Locks belong to open files, not to processes.
    const File other = File::update(path);
    CHECK(Reader(path).is_being_written());
    CHECK(test::has(refusal(path, test::numbered_head(), ErrorCode::io),
                    "another process is writing"));
  }
  CHECK_FALSE(Reader(path).is_being_written());
  Writer writer = Writer::resume(path, test::numbered_head());
  CHECK(
      test::has(refusal(path, test::numbered_head(), ErrorCode::io), "another process is writing"));
  // A new file under its name would take what it commits from now on out of sight.
  try {
    const Writer fresh(path, test::numbered_head());
    FAIL("a file that is being written was replaced");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::io);
  }
  CHECK_FALSE(std::filesystem::exists(path + ".partial"));
  test::write_numbered(writer, 3);
  writer.close();
  CHECK(test::holds_passes(Reader(path), 3));
}

TEST_CASE("what a dead writer left under the temporary name is taken over") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  test::save(path + ".partial", test::Bytes(100'000, std::byte{7}));
  test::write_numbered_file(path, Codec::raw, 2);
  CHECK(test::holds_passes(Reader(path), 2));
  CHECK_FALSE(std::filesystem::exists(path + ".partial"));
}

TEST_CASE("refresh sees exactly what is committed") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  std::optional<Writer> writer(std::in_place, path, test::numbered_head(),
                               WriterOptions{Codec::zstd, false, {}});
  test::write_numbered(*writer, 1);
  Reader reader(path);
  CHECK(reader.is_being_written());
  for (std::uint64_t pass = 1; pass < 70; ++pass) {
    CAPTURE(pass);
    CHECK_FALSE(reader.refresh());
    test::append_numbered(*writer, pass * test::kNumberedPass, test::kNumberedCapacity);
    CHECK_FALSE(reader.refresh());  // a chunk, but no commit
    CHECK(reader.records() == pass * test::kNumberedPass);
    test::append_numbered(*writer, pass * test::kNumberedPass + test::kNumberedCapacity,
                          test::kNumberedPass - test::kNumberedCapacity);
    writer->commit();
    CHECK(reader.refresh());
    CHECK(test::holds_passes(reader, pass + 1));
    if (pass % 10 != 9) continue;
    writer.reset();
    CHECK_FALSE(reader.is_being_written());
    CHECK_FALSE(reader.refresh());
    writer = Writer::resume(path, test::numbered_head(), {Codec::raw, false, {}});
  }
  CHECK_FALSE(reader.closed());
  writer->close();
  writer.reset();
  CHECK(reader.refresh());
  CHECK(reader.closed());
  CHECK(test::holds_passes(reader, 70));
  CHECK_FALSE(reader.refresh());

  test::write_numbered_file(scratch.path("other.pvb"), Codec::raw, 90);
  std::filesystem::rename(scratch.path("other.pvb"), path);
  try {
    static_cast<void>(reader.refresh());
    FAIL("another file was taken for this one");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::bad_input);
    CHECK(test::has(error.what(), "replaced"));
  }
  CHECK(test::holds_passes(reader, 70));  // what it had it still reads
}
