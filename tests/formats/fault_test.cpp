// Damage: one flipped bit, or pages zeroed, doubled, swapped or deleted, never gives a wrong value.
#include <fcntl.h>
#include <unistd.h>

#include <random>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "golden.h"

using namespace psf;
using namespace psf::formats;

namespace {

const std::vector<std::vector<test::Bytes>>& golden_chunks() {
  static const auto values = [] {
    std::vector<std::vector<test::Bytes>> out;
    const Reader reader(PSF_SOURCE_DIR "/sample_data/golden-raw.pvb");
    for (const ChunkEntry& entry : reader.chunks()) {
      out.emplace_back();
      for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
        out.back().push_back(test::golden_values(k, entry.first, entry.count));
      }
    }
    return out;
  }();
  return values;
}

struct Outcome {
  bool opened = false;
  std::size_t bad_columns = 0;
  std::size_t bad_chunk = 0;  // the last one
  bool named = true;          // every error names its chunk and its channel or its frame
};

// Opens and reads every column of every chunk. FAILs where a value is wrong, or where a pass is
// missing though the file is not `shorter`.
Outcome read_damaged(const std::string& path, bool shorter = false) {
  Outcome outcome;
  try {
    const Reader reader(path);
    outcome.opened = true;
    const bool part = shorter && reader.records() == test::kGoldenPass;
    if (reader.records() != test::kGoldenRecords && !part) FAIL("a pass is missing silently");
    const auto& expected = golden_chunks();
    test::Bytes out;
    for (std::size_t chunk = 0; chunk < reader.chunks().size(); ++chunk) {
      const ChunkEntry& entry = reader.chunks()[chunk];
      for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
        out.assign(entry.count * reader.head().channels[k].stride(), std::byte{0});
        try {
          reader.read(k, entry.first, entry.count, out);
          if (out != expected[chunk][k]) FAIL("a wrong value");
        } catch (const Error& error) {
          const std::string text = error.what();
          outcome.named = outcome.named && text.find("chunk " + std::to_string(chunk) +
                                                     " (records") != std::string::npos;
          ++outcome.bad_columns;
          outcome.bad_chunk = chunk;
        }
      }
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::bad_input && error.code() != ErrorCode::limit) throw;
  }
  return outcome;
}

// Whether check() finds the damage; refusing the file counts.
bool is_found(const std::string& path) {
  try {
    return !check(path).faults.empty();
  } catch (const Error&) {
    return true;
  }
}

std::size_t flip_bits(Codec codec, std::size_t step, std::size_t first) {
  const test::Scratch scratch;
  const std::string path = scratch.path("flip.pvb");
  test::write_golden(path, codec);
  const test::Bytes bytes = test::load(path);
  const auto all = test::frames(bytes);
  const int file = ::open(path.c_str(), O_RDWR);
  std::size_t flips = 0, not_found = 0, not_named = 0, too_many = 0, refused_wrongly = 0;
  for (std::size_t bit = first; bit < 8 * bytes.size(); bit += step) {
    const std::size_t place = bit / 8;
    const std::byte flipped = bytes[place] ^ static_cast<std::byte>(1u << bit % 8);
    REQUIRE(::pwrite(file, &flipped, 1, static_cast<off_t>(place)) == 1);
    const Outcome outcome = read_damaged(path);
    const auto frame =
        std::find_if(all.rbegin(), all.rend(), [&](const auto& f) { return f.offset <= place; });
    // Only HEAD and the last commit are needed to open a closed file.
    const bool needed = frame->type == "HEAD" || frame->offset == all.back().offset;
    if (!outcome.opened && !needed) ++refused_wrongly;
    if (!outcome.named) ++not_named;
    // A flip in a column is that column's alone; in the front of a chunk that chunk's.
    const std::size_t front = 64 + test::get(bytes, frame->offset + 56, 4);
    const std::size_t most = frame->type != "CHNK" ? 0 : place < frame->offset + front ? 19 : 1;
    if (outcome.bad_columns > most) ++too_many;
    if (!is_found(path)) ++not_found;
    REQUIRE(::pwrite(file, &bytes[place], 1, static_cast<off_t>(place)) == 1);
    ++flips;
  }
  ::close(file);
  CAPTURE(flips);
  CHECK(not_found == 0);
  CHECK(not_named == 0);
  CHECK(too_many == 0);
  CHECK(refused_wrongly == 0);
  CHECK(read_damaged(path).bad_columns == 0);
  CHECK_FALSE(is_found(path));
  return flips;
}

void copy_page(test::Bytes& bytes, std::size_t from, std::size_t to) {
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(from), 4096,
              bytes.begin() + static_cast<std::ptrdiff_t>(to));
}

std::size_t shuffle_pages(Codec codec, std::size_t count) {
  const test::Scratch scratch;
  const std::string path = scratch.path("pages.pvb");
  test::write_golden(path, codec);
  const test::Bytes whole = test::load(path);
  const std::size_t pages = whole.size() / 4096;
  std::mt19937 random(5);
  std::size_t not_found = 0, cases = 0, kinds[5] = {};
  while (cases < count) {
    test::Bytes bytes = whole;
    const std::size_t a = 4096 * (random() % pages), b = 4096 * (random() % pages);
    const std::size_t kind = random() % 5;
    switch (kind) {
      case 0:
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(a), 4096, std::byte{0});
        break;
      case 1:
        copy_page(bytes, a, b);
        break;
      case 2:
        copy_page(bytes, a, b);
        std::copy_n(whole.begin() + static_cast<std::ptrdiff_t>(b), 4096,
                    bytes.begin() + static_cast<std::ptrdiff_t>(a));
        break;
      case 3:  // doubled: everything behind moves
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(b),
                     whole.begin() + static_cast<std::ptrdiff_t>(a),
                     whole.begin() + static_cast<std::ptrdiff_t>(a) + 4096);
        break;
      default:  // deleted: no more than a cut file may lose
        bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(a),
                    bytes.begin() + static_cast<std::ptrdiff_t>(a) + 4096);
        break;
    }
    if (bytes == whole) continue;
    ++cases;
    ++kinds[kind];
    test::save(path, bytes);
    static_cast<void>(read_damaged(path, bytes.size() < whole.size()));
    // A page behind the last commit is a tail like any other.
    const bool tail =
        bytes.size() > whole.size() && std::equal(whole.begin(), whole.end(), bytes.begin());
    if (!tail && !is_found(path)) ++not_found;
  }
  CHECK(not_found == 0);
  for (const std::size_t cases_of_kind : kinds) CHECK(cases_of_kind > count / 10);
  return cases;
}

}  // namespace

TEST_CASE("one flipped bit never gives a wrong value, and check names it") {
  const std::size_t flips = flip_bits(Codec::raw, 131, 0) + flip_bits(Codec::zstd, 131, 7);
  CHECK(flips > 4000);
}

TEST_CASE("every single flipped bit never gives a wrong value, and check names it", "[.][long]") {
  const std::size_t flips = flip_bits(Codec::raw, 1, 0) + flip_bits(Codec::zstd, 1, 0);
  CHECK(flips >= 500'000);
}

TEST_CASE("pages zeroed, copied, swapped, doubled or deleted never give a wrong value") {
  CHECK(shuffle_pages(Codec::raw, 500) + shuffle_pages(Codec::zstd, 500) == 1000);
}

TEST_CASE("many pages zeroed, copied, swapped, doubled or deleted never give a wrong value",
          "[.][long]") {
  CHECK(shuffle_pages(Codec::raw, 50'000) + shuffle_pages(Codec::zstd, 50'000) >= 100'000);
}

TEST_CASE("a path-vertex buffer inside a column of another is a column") {
  const test::Scratch scratch;
  const std::string inner = scratch.path("inner.pvb"), path = scratch.path("outer.pvb");
  test::write_golden(inner, Codec::raw);
  const test::Bytes content = test::load(inner);
  Head head;
  head.channels = {{"pad", Type::u8, 1}, {"file", Type::u8, 1}};
  // The same uuid, the worst case: only places and numbers tell the frames apart.
  {
    Writer writer(path, head, {Codec::raw, false, test::golden_uuid()});
    const test::Bytes pad(4096 - 64 - 32 - 2 * 24 - 48);
    const std::size_t count = content.size();
    test::Bytes padding(count);
    const std::array<const void*, 2> columns = {padding.data(), content.data()};
    writer.append(count, columns);
    writer.commit();
    writer.append(count, columns);
    writer.commit();
  }
  test::Bytes bytes = test::load(path);
  const auto slot = test::frames(bytes, "SLOT").at(0);
  bytes.at(slot.offset) ^= std::byte{1};  // hop, not jump
  for (const bool broken : {false, true}) {
    if (broken) bytes.at(test::frames(test::load(path), "CHNK").at(0).offset + 3) ^= std::byte{1};
    test::save(path + ".2", bytes);
    const Reader reader(path + ".2");
    CHECK(reader.records() == 2 * content.size());
    test::Bytes out(content.size());
    if (broken) {
      CHECK_THROWS_AS(reader.read(1, 0, content.size(), out), Error);
    } else {
      reader.read(1, 0, content.size(), out);
      CHECK(out == content);
    }
    reader.read(1, content.size(), content.size(), out);
    CHECK(out == content);
  }
}
