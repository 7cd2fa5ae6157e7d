// Several threads read one Reader; a Reader opened while the file grows sees whole passes only.
#include <atomic>
#include <random>
#include <thread>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/read/reader.h"
#include "golden.h"

using namespace psf;
using namespace psf::formats;

TEST_CASE("several threads read the same values") {
  const test::Scratch scratch;
  test::write_golden(scratch.path("g.pvb"), Codec::zstd);
  const Reader reader(scratch.path("g.pvb"));
  std::atomic<std::size_t> wrong = 0;
  const auto work = [&](unsigned seed) {
    std::mt19937 random(seed);
    for (int k = 0; k < 2000; ++k) {
      const std::size_t channel = random() % reader.head().channels.size();
      const std::size_t first = random() % test::kGoldenRecords;
      const std::size_t count = random() % (test::kGoldenRecords - first + 1);
      test::Bytes out(count * reader.head().channels[channel].stride());
      reader.read(channel, first, count, out);
      if (out != test::golden_values(channel, first, count)) ++wrong;
    }
  };
  std::vector<std::thread> threads;
  for (unsigned k = 0; k < 4; ++k) threads.emplace_back(work, k);
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
}

TEST_CASE("a reader of a growing file sees whole passes, and more and more of them") {
  const test::Scratch scratch;
  const std::string path = scratch.path("grow.pvb");
  Head head;
  head.channels = {{"n", Type::u64, 1}};
  head.chunk_capacity = 100;
  constexpr std::uint64_t kPass = 250, kPasses = 300;
  constexpr std::uint64_t kLook = 100;  // after so many passes, wait for the reader to look
  std::atomic<bool> done = false;
  std::atomic<std::uint64_t> opened = 0;
  std::thread writing([&] {
    Writer writer(path, head, {Codec::zstd, false, {}});
    for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
      std::vector<std::uint64_t> values(kPass);
      for (std::uint64_t k = 0; k < kPass; ++k) values[k] = pass * kPass + k;
      const std::array<const void*, 1> columns = {values.data()};
      writer.append(kPass, columns);
      writer.commit();
      while (opened <= pass / kLook && pass % kLook == kLook - 1) std::this_thread::yield();
    }
    writer.close();
    done = true;
  });
  std::uint64_t seen = 0, wrong = 0;
  bool last = false;
  while (!last) {
    last = done;
    try {
      const Reader reader(path);
      ++opened;
      if (reader.records() < seen || reader.records() % kPass != 0) ++wrong;
      seen = reader.records();
      const std::uint64_t from = seen - std::min<std::uint64_t>(seen, 2 * kPass);
      std::vector<std::uint64_t> values(seen - from);
      reader.read(0, from, values.size(), std::as_writable_bytes(std::span(values)));
      for (std::size_t k = 0; k < values.size(); ++k) wrong += values[k] != from + k;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::io || seen > 0) ++wrong;  // not there before its first pass
    }
  }
  writing.join();
  CHECK(wrong == 0);
  CHECK(seen == kPass * kPasses);
  CHECK(opened > kPasses / kLook);  // and once when it was done
}
