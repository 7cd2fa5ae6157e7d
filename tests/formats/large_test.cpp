// Sizes: more than 2^32 records, offsets past 2^32, and 200 GB opened by reading the index alone.
#include <fcntl.h>
#include <unistd.h>

#include "catch.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/layout/chunk.h"
#include "formats/layout/commit.h"
#include "formats/layout/crc.h"
#include "formats/layout/frame.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"
#include "formats/layout/slot.h"
#include "formats/read/reader.h"
#include "golden.h"

using namespace psf;
using namespace psf::formats;

namespace {

constexpr std::uint64_t kRecords32 = std::uint64_t{1} << 32;

// A file of `chunks` chunks of one channel u8, all zeros but the first record of each, which is its
// chunk's number modulo 256. Columns are holes; with `fronts`, the chunks are there to be read.
void write_sparse(const std::string& path, std::uint64_t chunks, std::uint32_t count,
                  std::uint64_t spread, bool fronts) {
  Head head;
  head.chunk_capacity = count;
  head.channels = {{"value", Type::u8, 1}};
  const Uuid uuid = test::golden_uuid();
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0666);
  REQUIRE(file >= 0);
  const auto put = [&](std::uint64_t offset, std::span<const std::byte> bytes) {
    REQUIRE(::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset)) ==
            static_cast<ssize_t>(bytes.size()));
  };
  const auto head_front = encode_front({uuid, kHeadType, 1, 0, kPage, 0}, encode_head(head));
  put(0, head_front);
  put(kPage, encode_front({uuid, kSlotType, 0, kPage, kPage, 1}, {}));
  const std::uint64_t length = align_up(192 + std::uint64_t{count}, kPage) + spread;
  std::vector<ChunkEntry> entries;
  std::vector<std::uint32_t> checksums;
  test::Bytes column(fronts ? count : 0);
  for (unsigned k = 0; fronts && k < 256; ++k) {
    column[0] = static_cast<std::byte>(k);
    checksums.push_back(k < 2 || chunks > k ? crc32(column) : 0);
  }
  for (std::uint64_t k = 0; k < chunks; ++k) {
    const std::uint64_t offset = 2 * kPage + k * length;
    entries.push_back({offset, length, k * count, count, 0});
    if (!fronts) continue;
    Chunk chunk{
        0, k * count, count, 0, {{0, Codec::raw, Filter::none, checksums[k % 256], 128, count}}};
    put(offset, encode_front({uuid, kChunkType, 1, offset, length, 2 + k}, encode_chunk(chunk)));
    const std::byte first{static_cast<unsigned char>(k % 256)};
    put(offset + 128, {&first, 1});
  }
  const auto index = encode_index(entries);
  Commit commit;
  commit.flags = kClosed;
  commit.number = 1;
  commit.records = chunks * count;
  commit.chunks = chunks;
  commit.passes = 1;
  commit.index = {0, index.size(), crc32(index)};
  commit.head = {0, head_front.size(), crc32(head_front)};
  place_sections(commit);
  const std::uint64_t end = 2 * kPage + chunks * length;
  const Prefix prefix{uuid, kCommitType, 1, end, commit_length(commit), 2 + chunks};
  put(end, encode_front(prefix, encode_commit(commit)));
  put(end + commit.index.offset, index);
  put(end + commit.head.offset, head_front);
  REQUIRE(::ftruncate(file, static_cast<off_t>(end + prefix.length)) == 0);
  put(kPage + slot_record_offset(1), encode_slot_record({end, prefix.length, prefix.sequence}));
  ::close(file);
}

}  // namespace

TEST_CASE("records and offsets past 2^32 are right") {
  const test::Scratch scratch;
  const std::string path = scratch.path("large.pvb");
  write_sparse(path, 258, 1u << 24, 0, true);
  for (const bool by_slot : {true, false}) {
    if (!by_slot) {
      const int file = ::open(path.c_str(), O_RDWR);
      REQUIRE(::pwrite(file, "x", 1, kPage) == 1);
      ::close(file);
    }
    const Reader reader(path);
    CHECK(reader.records() == 258 * (std::uint64_t{1} << 24));
    CHECK(reader.file_bytes() > kRecords32);
    std::array<std::byte, 4> out{};
    reader.read(0, kRecords32 - 2, 4,
                out);  // the last two of chunk 255, the first two of chunk 256
    CHECK(out == std::array<std::byte, 4>{});
    reader.read(0, kRecords32 - (1u << 24), 4, out);
    CHECK(out == std::array{std::byte{255}, std::byte{0}, std::byte{0}, std::byte{0}});
    reader.read(0, kRecords32 + (1u << 24) - 1, 2, std::span(out).first(2));
    CHECK(out[0] == std::byte{0});
    CHECK(out[1] == std::byte{1});  // chunk 257
    for (const std::uint64_t first : {kRecords32 - 1, kRecords32, kRecords32 + 1}) {
      reader.read(0, first, 1, std::span(out).first(1));
      CHECK(out[0] == std::byte{0});
    }
  }
}

TEST_CASE("200 GB are opened by reading the index and little else") {
  const test::Scratch scratch;
  const std::string path = scratch.path("huge.pvb");
  write_sparse(path, 50000, 65536, (std::uint64_t{4} << 20) - 2 * 65536, false);
  const std::uint64_t before = test::calls().bytes_read;
  const Reader reader(path);
  const std::uint64_t bytes_read = test::calls().bytes_read - before;
  CHECK(reader.file_bytes() > 200'000'000'000);
  CHECK(reader.records() == std::uint64_t{50000} * 65536);
  constexpr std::uint64_t kIndex = 50000 * 32;  // an entry a chunk
  CHECK(bytes_read >= kIndex);
  CHECK(bytes_read < 3 * kIndex);
}
