// recover(): what cannot be saved, what must not be touched, and failing system calls.
#include <unistd.h>

#include <filesystem>
#include <optional>

#include "catch.h"
#include "core/error.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/check/recover.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

struct Refusal {
  std::optional<ErrorCode> code;
  std::string text;
};

Refusal refusal(const std::string& in, const std::string& out) {
  try {
    static_cast<void>(recover(in, out));
  } catch (const Error& error) {
    CHECK(std::string(error.what()).find('\n') == std::string::npos);
    return {error.code(), error.what()};
  }
  return {};
}

}  // namespace

TEST_CASE("what is no path-vertex buffer cannot be recovered, and nothing is written") {
  const test::Scratch scratch;
  const std::string in = scratch.path("in.pvb"), out = scratch.path("out.pvb");
  CHECK(refusal(in, out).code == ErrorCode::io);
  CHECK(refusal(scratch.path(""), out).code == ErrorCode::io);
  for (const std::size_t size : {0u, 1u, 63u, 64u, 4096u, 100'000u}) {
    for (const char value : {'\0', 'P'}) {
      CAPTURE(size);
      test::save(in, test::Bytes(size, std::byte{static_cast<unsigned char>(value)}));
      const Refusal said = refusal(in, out);
      CHECK(said.code == ErrorCode::bad_input);
      CHECK(said.text.find(in) == 0);
    }
  }
  // HEAD and SLOT alone.
  test::write_numbered_file(in, Codec::raw, 1);
  test::Bytes bytes = test::load(in);
  bytes.resize(8192);
  test::save(in, bytes);
  CHECK(refusal(in, out).code == ErrorCode::bad_input);
  CHECK_FALSE(std::filesystem::exists(out));
  CHECK_FALSE(std::filesystem::exists(out + ".partial"));
}

TEST_CASE("the damaged file itself is never written, by whatever name") {
  const test::Scratch scratch;
  const std::string in = scratch.path("in.pvb");
  test::write_numbered_file(in, Codec::raw, 2);
  const test::Bytes whole = test::load(in);
  std::filesystem::create_hard_link(in, scratch.path("hard.pvb"));
  std::filesystem::create_symlink(in, scratch.path("soft.pvb"));
  for (const char* name : {"in.pvb", "./in.pvb", "hard.pvb", "soft.pvb"}) {
    CAPTURE(name);
    CHECK(refusal(in, scratch.path(name)).code == ErrorCode::usage);
  }
  // A file that its writer left under the temporary name, to be saved under the final one.
  const std::string partial = scratch.path("left.pvb.partial");
  test::save(partial, whole);
  CHECK(refusal(partial, scratch.path("left.pvb")).code == ErrorCode::usage);
  const bool same = test::load(in) == whole && test::load(partial) == whole;
  CHECK(same);
}

TEST_CASE("whichever write, sync, rename or close of recover() fails, nothing is left") {
  const test::Scratch scratch;
  const std::string in = scratch.path("in.pvb"), out = scratch.path("out.pvb");
  test::write_numbered_file(in, Codec::zstd, 3);
  test::Bytes bytes = test::load(in);
  bytes.at(test::frames(bytes, "CHNK").at(4).offset + 70) ^= std::byte{1};
  test::save(in, bytes);
  int cases = 0;
  for (const bool torn : {false, true}) {
    test::calls().tear = torn;
    std::optional<ErrorCode> code;
    const auto work = [&] {
      std::filesystem::remove(out);
      code.reset();
      try {
        static_cast<void>(recover(in, out));
      } catch (const Error& error) {
        code = error.code();
      }
    };
    int whole = 0, silent = 0, closes = 0;
    cases += test::fail_each(work, [&](int n) {
      CAPTURE(torn, n);
      CHECK_FALSE(std::filesystem::exists(out + ".partial"));
      CHECK(test::load(in) == bytes);
      if (code) CHECK(code == ErrorCode::io);
      if (code && test::calls().failed == std::string("close")) ++closes;
      // The last close, behind one that told that all is kept.
      if (!code) ++silent;
      // Otherwise only where the folder could not be synced, when all is done.
      CHECK((code || std::filesystem::exists(out)));
      if (std::filesystem::exists(out)) {
        ++whole;
        CHECK(check(out).faults.empty());
        CHECK(test::wrong_columns(Reader(out)) == 0);
      }
    });
    CHECK(whole == 2);
    CHECK(silent == 1);
    CHECK(closes == 1);  // before the rename
    test::calls().tear = false;
  }
  CAPTURE(cases);
  CHECK(cases > 30);
}

TEST_CASE("an output that is being written is not replaced") {
  const test::Scratch scratch;
  const std::string in = scratch.path("in.pvb"), out = scratch.path("out.pvb");
  test::write_numbered_file(in, Codec::raw, 2);
  Writer writer(out, test::numbered_head(), {Codec::raw, false, {}});
  test::write_numbered(writer, 1);
  CHECK(refusal(in, out).code == ErrorCode::io);
  test::write_numbered(writer, 2);
  CHECK(test::holds_passes(Reader(out), 2));
  CHECK_FALSE(std::filesystem::exists(out + ".partial"));
}

TEST_CASE("progress may stop recover(), and nothing is left") {
  const test::Scratch scratch;
  const std::string in = scratch.path("in.pvb"), out = scratch.path("out.pvb");
  test::write_numbered_file(in, Codec::raw, 3);
  std::uint64_t calls = 0;
  const auto stop = [&](std::uint64_t done, std::uint64_t total) {
    CHECK(done <= total);
    if (++calls == 4) throw Error(ErrorCode::interrupted, "stopped");
  };
  CHECK_THROWS_AS(recover(in, out, {}, stop), Error);
  CHECK(calls == 4);
  CHECK_FALSE(std::filesystem::exists(out));
  CHECK_FALSE(std::filesystem::exists(out + ".partial"));
}
