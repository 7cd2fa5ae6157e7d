// A file that was stopped anywhere and goes on is the same as one that never stopped.
#include <filesystem>

#include "catch.h"
#include "core/error.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/layout/file.h"
#include "formats/read/reader.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

constexpr std::uint64_t kResumedPasses = 5;

enum class Stop { closed, committed, tail, torn_chunk, torn_commit };
constexpr Stop kStops[] = {Stop::closed, Stop::committed, Stop::tail, Stop::torn_chunk,
                           Stop::torn_commit};

WriterOptions options(Codec codec) {
  return {codec, false, {}};
}

// A file with so many committed passes, stopped in one of these ways.
void write_stopped(const std::string& path, Codec codec, std::uint64_t passes, Stop stop) {
  test::Bytes left;
  {
    Writer writer(path, test::numbered_head(), options(codec));
    test::write_numbered(writer, passes);
    if (stop == Stop::closed) writer.close();
    // Destructors cut the tail off that a kill would leave.
    if (stop == Stop::tail || stop == Stop::torn_chunk) {
      test::append_numbered(writer, passes * test::kNumberedPass, 2 * test::kNumberedCapacity);
    } else if (stop == Stop::torn_commit) {
      test::write_numbered(writer, passes + 1);
    }
    left = test::load(path);
  }
  if (stop == Stop::torn_chunk) left.resize(left.size() - 4000);
  if (stop == Stop::torn_commit) left.resize(left.size() - 3900);
  test::save(path, left);
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// All but SLOT, the only page that is ever written again.
bool same_committed(const test::Bytes& before, const test::Bytes& after, std::uint64_t end) {
  const auto slot = test::frames(test::Bytes(after.begin(), after.begin() + 8192), "SLOT").at(0);
  const auto equal = [&](std::size_t from, std::size_t to) {
    return to <= after.size() && std::equal(before.begin() + static_cast<std::ptrdiff_t>(from),
                                            before.begin() + static_cast<std::ptrdiff_t>(to),
                                            after.begin() + static_cast<std::ptrdiff_t>(from));
  };
  return equal(0, slot.offset) && equal(slot.offset + slot.length, end);
}

// Goes on to the end and compares with the formula.
void check_resumed(const std::string& path, Codec codec, std::uint64_t passes) {
  const test::Bytes before = test::load(path);
  std::uint64_t end = 0;
  {
    const Reader reader(path);
    end = reader.file_bytes() - reader.uncommitted_bytes();
  }
  {
    Writer writer = Writer::resume(path, test::numbered_head(), options(codec));
    REQUIRE(writer.passes() == passes);
    CHECK(writer.records() == passes * test::kNumberedPass);
    CHECK(text_of(writer.resume_state()) == test::numbered_state(passes));
    test::write_numbered(writer, kResumedPasses);
    writer.close();
  }
  const Reader reader(path);
  CHECK(test::holds_passes(reader, kResumedPasses));
  CHECK(reader.closed());
  CHECK(reader.uncommitted_bytes() == 0);
  CHECK(text_of(reader.resume_state()) == test::numbered_state(kResumedPasses));
  const std::vector<Fault> faults = check(path).faults;
  CHECK(faults.empty());
  CHECK(same_committed(before, test::load(path), end));
}

void resume_cut_files(std::size_t step) {
  const test::Scratch scratch;
  const std::string path = scratch.path("cut.pvb");
  std::size_t cuts = 0;
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    test::write_numbered_file(path, codec, kResumedPasses);
    const test::Bytes whole = test::load(path);
    const auto commits = test::frames(whole, "CMIT");
    for (std::size_t size = whole.size() - 1; size >= commits[0].offset + commits[0].length;
         size -= std::min(step, size)) {
      test::save(path, std::span(whole).first(size));
      std::uint64_t passes = 0;
      for (const auto& commit : commits) {
        if (commit.offset + commit.length <= size) {
          passes = test::get(whole, commit.offset + 64 + 32, 8);
        }
      }
      CAPTURE(size);
      check_resumed(path, codec, passes);
      ++cuts;
    }
  }
  CAPTURE(cuts);
  CHECK(cuts > 100'000 / step);
}

}  // namespace

TEST_CASE("a file that was stopped in any way goes on as if it never had been") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    for (std::uint64_t passes = 1; passes < kResumedPasses; ++passes) {
      for (const Stop stop : kStops) {
        CAPTURE(passes, static_cast<int>(stop));
        write_stopped(path, codec, passes, stop);
        check_resumed(path, codec, passes);
      }
    }
  }
}

TEST_CASE("a file that was cut anywhere goes on from the last commit before the cut") {
  resume_cut_files(1013);
}

TEST_CASE("a file that was cut at every byte goes on from the last commit before", "[.][long]") {
  resume_cut_files(1);
}

TEST_CASE("resuming with nothing new to say leaves the file as it is") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  for (const Stop stop : kStops) {
    CAPTURE(static_cast<int>(stop));
    write_stopped(path, Codec::zstd, 2, stop);
    const test::Bytes before = test::load(path);
    { const Writer writer = Writer::resume(path, test::numbered_head()); }
    CHECK(test::load(path) == before);
    if (stop != Stop::closed) continue;
    Writer writer = Writer::resume(path, test::numbered_head());
    writer.close();
    CHECK(test::load(path) == before);
  }
}

TEST_CASE("a resumed file may change codec and be stopped again without a commit") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  write_stopped(path, Codec::raw, 2, Stop::torn_chunk);
  for (std::uint64_t pass = 3; pass <= 6; ++pass) {
    Writer writer = Writer::resume(path, test::numbered_head(),
                                   options(pass % 2 == 0 ? Codec::raw : Codec::zstd));
    test::write_numbered(writer, pass);
    test::append_numbered(writer, pass * test::kNumberedPass, 20);  // never committed
  }
  const Reader reader(path);
  CHECK(test::holds_passes(reader, 6));
  CHECK(reader.uncommitted_bytes() == 0);
  CHECK(check(path).faults.empty());
}

TEST_CASE("whichever write, sync or close of a resumed file fails, the last commit is readable") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  const std::string stopped = scratch.path("stopped.pvb");
  int cases = 0;
  for (const Stop stop : kStops) {
    write_stopped(stopped, Codec::raw, 2, stop);
    std::uint64_t passes = 0;
    const auto resume = [&] {
      std::filesystem::copy_file(stopped, path, std::filesystem::copy_options::overwrite_existing);
      passes = 2;
      try {
        Writer writer = Writer::resume(path, test::numbered_head(), {Codec::raw, true, {}});
        for (; passes < 4; ++passes) test::write_numbered(writer, passes + 1);
        writer.close();
      } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::io);
      }
    };
    cases += test::fail_each(resume, [&](int n) {
      CAPTURE(static_cast<int>(stop), n);
      CHECK(test::holds_passes(Reader(path), passes));
      for (const Fault& fault : check(path).faults) CHECK(fault.frame == "SLOT");
    });
  }
  CAPTURE(cases);
  CHECK(cases > 50);
}

TEST_CASE("the index stays whole over thousands of commits, resumes and closes, and small") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  constexpr std::uint64_t kCommits = 4096 + 200, kRun = 173;
  std::uint64_t closes = 0, pages = 2;
  long most_reads = 0;
  Head head;
  head.channels = {{"n", Type::u64, 1}};
  for (std::uint64_t pass = 0; pass < kCommits;) {
    Writer writer = pass == 0 ? Writer(path, head, options(Codec::raw))
                              : Writer::resume(path, head, options(Codec::raw));
    REQUIRE(writer.passes() == pass);
    const std::uint64_t until = std::min(pass + kRun, kCommits);
    for (; pass < until; ++pass) {
      const std::array<const void*, 1> columns = {&pass};
      writer.append(1, columns);
      writer.commit();
    }
    if (until % 2 == 0) {
      writer.close();
      ++closes;
    }
    test::calls().reads = 0;
    const Reader reader(path);
    most_reads = std::max<long>(most_reads, test::calls().reads);
    REQUIRE(reader.chunks().size() == pass);
    REQUIRE(reader.passes().size() == pass);
  }
  const Reader reader(path);
  CHECK(test::numbers_of(reader) == test::numbers_from(0, kCommits));
  CHECK(check(path).faults.empty());
  // Two reads a commit of the chain, and a few at the start.
  CHECK(most_reads <= 2 * 66 + 8);
  // Two pages a pass, a page a close, and the indices.
  pages += 2 * kCommits + closes;
  CHECK(reader.file_bytes() < pages * 4096 + (kCommits / 64 + closes) * 32 * kCommits);
}
