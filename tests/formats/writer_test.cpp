// The writer: a name never holds less than a pass, misuse is an error, what it writes checks out.
#include "formats/write/writer.h"

#include <filesystem>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "golden.h"

using namespace psf;
using namespace psf::formats;

namespace {

Head small_head() {
  Head head;
  head.channels = {{"n", Type::u32, 1}};
  head.chunk_capacity = 4;
  return head;
}

void append(Writer& writer, std::uint32_t count) {
  std::vector<std::uint32_t> values(count);
  for (std::uint32_t k = 0; k < count; ++k) values[k] = k;
  const std::array<const void*, 1> columns = {values.data()};
  writer.append(count, columns);
}

ErrorCode code_of(const std::string& path, const Head& head) {
  try {
    const Writer writer(path, head);
  } catch (const Error& error) {
    CHECK(std::string(error.what()).find('\n') == std::string::npos);
    return error.code();
  }
  return ErrorCode::comparison;
}

}  // namespace

TEST_CASE("a file appears with its first pass and not before") {
  namespace fs = std::filesystem;
  const test::Scratch scratch;
  const std::string path = scratch.path("w.pvb");
  {
    Writer writer(path, small_head());
    append(writer, 9);
    CHECK_FALSE(fs::exists(path));
    CHECK(fs::exists(path + ".partial"));
  }
  CHECK_FALSE(fs::exists(path));
  CHECK_FALSE(fs::exists(path + ".partial"));

  test::save(path, test::Bytes(10));
  {
    Writer writer(path, small_head());
    append(writer, 9);
    CHECK(fs::file_size(path) == 10);
    writer.commit();
    CHECK(fs::file_size(path) == writer.bytes_written());
    CHECK_FALSE(fs::exists(path + ".partial"));
    append(writer, 9);  // never committed
  }
  const Reader reader(path);
  CHECK(reader.records() == 9);
  CHECK_FALSE(reader.closed());
  CHECK(reader.uncommitted_bytes() == 0);
  CHECK(check(path).faults.empty());
}

TEST_CASE("a head that breaks a limit is refused before anything is written") {
  const test::Scratch scratch;
  const std::string path = scratch.path("w.pvb");
  const auto refused = [&](const auto& change) {
    Head head = small_head();
    change(head);
    const ErrorCode code = code_of(path, head);
    return (code == ErrorCode::bad_input || code == ErrorCode::limit) &&
           !std::filesystem::exists(path + ".partial");
  };
  CHECK(refused([](Head& h) { h.channels.clear(); }));
  CHECK(refused([](Head& h) { h.channels.push_back(h.channels[0]); }));
  CHECK(refused([](Head& h) { h.channels[0].name = ""; }));
  CHECK(refused([](Head& h) { h.channels[0].name = "a b"; }));
  CHECK(refused([](Head& h) { h.channels[0].name = std::string(57, 'a'); }));
  CHECK(refused([](Head& h) { h.channels[0].components = 0; }));
  CHECK(refused([](Head& h) { h.channels[0].components = 17; }));
  CHECK(refused([](Head& h) { h.channels[0].type = Type{9}; }));
  CHECK(refused([](Head& h) { h.channels[0].encoding = Encoding{2}; }));
  CHECK(refused([](Head& h) { h.channels[0].encoding = Encoding::octahedral; }));
  CHECK(refused([](Head& h) { h.chunk_capacity = 0; }));
  CHECK(refused([](Head& h) { h.chunk_capacity = (1u << 24) + 1; }));
  CHECK(refused([](Head& h) {
    h.channels[0] = {"wide", Type::f64, 16};
    h.chunk_capacity = (1u << 23) + 1;
  }));
  CHECK(refused([](Head& h) { h.metadata = "[1]"; }));
  CHECK(refused([](Head& h) { h.metadata = "{"; }));
  CHECK(refused([](Head& h) { h.metadata = "{\"a\":\"" + std::string(1 << 20, 'x') + "\"}"; }));
  CHECK(refused([](Head& h) {
    for (int k = 0; k < 256; ++k) h.channels.push_back({"c" + std::to_string(k), Type::u8, 1});
  }));
  CHECK_FALSE(refused([](Head& h) {
    for (int k = 0; k < 255; ++k) h.channels.push_back({"c" + std::to_string(k), Type::u8, 1});
  }));
}

TEST_CASE("a name that cannot be written is refused at once") {
  const test::Scratch scratch;
  CHECK(code_of(scratch.path("none/w.pvb"), small_head()) == ErrorCode::io);
  CHECK(code_of(scratch.path(""), small_head()) == ErrorCode::io);
  CHECK(code_of("", small_head()) == ErrorCode::io);
  CHECK(code_of("/dev/null", small_head()) == ErrorCode::io);
  CHECK(std::filesystem::is_character_file("/dev/null"));
  const Writer first(scratch.path("w.pvb"), small_head());
  CHECK(code_of(scratch.path("w.pvb"), small_head()) == ErrorCode::io);  // two writers
  CHECK(std::filesystem::exists(scratch.path("w.pvb.partial")));
}

TEST_CASE("misuse is an error that sticks") {
  const test::Scratch scratch;
  const std::string path = scratch.path("w.pvb");
  {
    Writer writer(path, small_head());
    CHECK_THROWS_AS(writer.commit(), Error);  // a pass without records
    CHECK_THROWS_AS(append(writer, 1), Error);
  }
  {
    Writer writer(path, small_head());
    CHECK_THROWS_AS(writer.append(1, {}), Error);
  }
  {
    Writer writer(path, small_head());
    append(writer, 1);
    CHECK_THROWS_AS(writer.commit(std::vector<std::byte>(65537)), Error);
  }
  {
    Writer writer(path, small_head());
    append(writer, 1);
    CHECK_THROWS_AS(writer.close(), Error);  // not committed
  }
  {
    Writer writer(path, small_head());
    CHECK_THROWS_AS(writer.close(), Error);  // nothing in it
  }
  CHECK_FALSE(std::filesystem::exists(path));
  Writer writer(path, small_head());
  append(writer, 5);
  writer.commit(std::vector<std::byte>(65536, std::byte{7}));
  writer.close();
  CHECK_THROWS_AS(append(writer, 1), Error);
  const Reader reader(path);
  CHECK(reader.closed());
  CHECK(reader.resume_state() == std::vector<std::byte>(65536, std::byte{7}));
}

TEST_CASE("the index is whole over thousands of commits, and its cost stays small") {
  const test::Scratch scratch;
  const std::string path = scratch.path("w.pvb");
  constexpr std::uint32_t kCommits = 4096 + 64 + 5;
  std::uint64_t bytes = 0;
  {
    Writer writer(path, small_head(), {Codec::raw, false, {}});
    for (std::uint32_t k = 1; k <= kCommits; ++k) {
      append(writer, 4);
      writer.commit();
      // Around the steps of the index, and now and then.
      if (k % 997 == 0 || k % 4096 <= 1 || (k % 64 <= 1 && k > 4000) || k < 4) {
        const Reader reader(path);
        if (reader.records() != 4 * k || reader.chunks().size() != k) FAIL("index of commit " << k);
      }
    }
    bytes = writer.bytes_written();
  }
  CHECK(Reader(path).passes().size() == kCommits);
  // Every chunk and every commit is one: commit k has chunks up to k, and begins its index as the
  // rule has it.
  const test::Bytes file = test::load(path);
  std::uint64_t k = 0, wrong = 0;
  for (const auto& commit : test::frames(file, "CMIT")) {
    ++k;
    const std::uint64_t first = k % 4096 == 0 ? 0 : k % 64 == 0 ? k / 4096 * 4096 : k - 1;
    wrong += test::get(file, commit.offset + 64 + 56, 8) != first;
  }
  CHECK(k == kCommits);
  CHECK(wrong == 0);
  CHECK(check(path).faults.empty());
  // A chunk and a commit are a page each; the 64 whole indices add 32 bytes a chunk each.
  CHECK(bytes < kCommits * (2 * 4096 + 64 * 32));
}
