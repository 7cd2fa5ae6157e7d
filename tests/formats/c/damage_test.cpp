// Damage: the reader of the C header never gives a wrong value, and reads what is whole.
#include <algorithm>
#include <random>

#include "c_file.h"
#include "catch.h"
#include "golden.h"

using namespace psf;
using test::Bytes;
using test::CFile;

namespace {

struct Tally {
  std::size_t refused = 0, unreadable = 0, wrong = 0;
};

constexpr std::size_t kChannels = 19;

// Two passes of two chunks, of `pass` records a pass and `chunk` a chunk; `expected` by chunk and
// channel.
struct Sample {
  Sample(std::size_t pass, std::size_t chunk) : records(2 * pass) {
    const test::Scratch scratch;
    const std::string path = scratch.path("sample.pvb");
    const formats::Head head = test::golden_head();
    const formats::Uuid uuid = test::golden_uuid();
    const pvb_options options = {static_cast<std::uint32_t>(chunk), 1, uuid.data()};
    const auto channels = test::c_channels(head);
    const CFile file(pvb_create(path.c_str(), channels.data(), channels.size(),
                                head.metadata.c_str(), &options));
    for (const std::size_t start : {std::size_t{0}, pass}) {
      test::append_golden(file.get(), start, pass);
      pvb_commit(file.get(), nullptr, 0);
      first.insert(first.end(), {start, start + chunk});
    }
    pvb_close(file.get());
    bytes = test::load(path);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t count = k % 2 == 0 ? chunk : pass - chunk;
      expected.emplace_back();
      for (std::size_t channel = 0; channel < kChannels; ++channel) {
        expected.back().push_back(test::golden_values(channel, first[k], count));
      }
    }
  }

  // Whether the channel of a chunk can be read; counts a wrong value and an error without place.
  bool read(const CFile& file, std::size_t chunk, std::size_t channel, Tally& tally) const {
    const std::size_t count = (chunk + 1 < 4 ? first[chunk + 1] : records) - first[chunk];
    const Bytes values = test::c_read(file.get(), channel, first[chunk], count);
    if (values == expected[chunk][channel]) return true;
    const std::string where = "chunk " + std::to_string(chunk) + " (records ";
    if (!values.empty() || file.error().find(where) == std::string::npos) ++tally.wrong;
    return false;
  }

  Bytes bytes;
  std::size_t records;
  std::vector<std::size_t> first;  // record of each chunk
  std::vector<std::vector<Bytes>> expected;
};

// Opens the file and reads every chunk of every channel.
void read_damaged(const Sample& sample, const std::string& path, Tally& tally) {
  const CFile file(pvb_open(path.c_str()));
  if (!file.error().empty()) {
    ++tally.refused;
    return;
  }
  if (file.info().records != sample.records) ++tally.wrong;
  for (std::size_t chunk = 0; chunk < 4; ++chunk) {
    for (std::size_t channel = 0; channel < kChannels; ++channel) {
      if (sample.read(file, chunk, channel, tally)) continue;
      ++tally.unreadable;
      // What was read before is not mixed up with what could not be.
      if (chunk > 0) static_cast<void>(sample.read(file, chunk - 1, channel, tally));
    }
  }
}

}  // namespace

TEST_CASE("one flipped bit, anywhere, is told or harmless") {
  const test::Scratch scratch;
  const std::string path = scratch.path("flip.pvb");
  const Sample sample(24, 16);
  const Bytes& whole = sample.bytes;
  const auto frames = test::frames(whole);
  Tally tally;
  std::size_t refused_wrongly = 0;
  for (std::size_t bit = 3; bit < 8 * whole.size(); bit += 397) {
    Bytes bytes = whole;
    bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    test::save(path, bytes);
    const std::size_t before = tally.refused;
    read_damaged(sample, path, tally);
    // Only HEAD and the last commit are needed to open a closed file.
    const bool needed = bit / 8 < frames[1].offset || bit / 8 >= frames.back().offset;
    refused_wrongly += tally.refused > before && !needed;
  }
  CHECK(tally.wrong == 0);
  CHECK(refused_wrongly == 0);
  CHECK(tally.refused > 0);
  CHECK(tally.unreadable > 0);
}

TEST_CASE("pages zeroed, doubled, swapped or copied never give a wrong value") {
  const test::Scratch scratch;
  const std::string path = scratch.path("pages.pvb");
  const Sample sample(200, 120);  // chunks of several pages
  const Bytes& whole = sample.bytes;
  const auto at = [](Bytes& bytes, std::size_t page) {
    return bytes.begin() + static_cast<std::ptrdiff_t>(4096 * page);
  };
  std::mt19937 random(3);
  Tally tally;
  for (int round = 0; round < 700; ++round) {
    Bytes bytes = whole;
    Bytes source = whole;
    const std::size_t pages = whole.size() / 4096, a = random() % pages, b = random() % pages;
    switch (random() % 4) {
      case 0:
        std::fill_n(at(bytes, a), 4096, std::byte{0});
        break;
      case 1:
        std::copy_n(at(source, a), 4096, at(bytes, b));
        break;
      case 2:
        std::copy_n(at(source, a), 4096, at(bytes, b));
        std::copy_n(at(source, b), 4096, at(bytes, a));
        break;
      default:
        bytes.insert(at(bytes, b), at(source, a), at(source, a) + 4096);
        break;
    }
    test::save(path, bytes);
    read_damaged(sample, path, tally);
  }
  CHECK(tally.wrong == 0);
  CHECK(tally.unreadable > 0);
}

TEST_CASE("a chunk that says other than the index is not read") {
  const test::Scratch scratch;
  const std::string path = scratch.path("says.pvb");
  const Sample sample(24, 16);
  for (const std::size_t field : {std::size_t{64}, std::size_t{72}, std::size_t{76}}) {
    Bytes bytes = sample.bytes;
    const std::size_t at = test::frames(bytes, "CHNK").at(1).offset;
    test::put(bytes, at + field, 4, test::get(bytes, at + field, 4) - 1);
    test::mend(bytes, at);
    test::save(path, bytes);
    Tally tally;
    read_damaged(sample, path, tally);
    CHECK(tally.unreadable == kChannels);
    CHECK(tally.wrong == 0);
  }
}

TEST_CASE("a path-vertex buffer inside a column of another, of the same uuid, is a column") {
  const test::Scratch scratch;
  const std::string path = scratch.path("outer.pvb");
  const Sample inner(24, 16);
  // As many bytes of padding as make the second column start on a page.
  Bytes content = inner.bytes, bytes;
  content.resize(content.size() + 4096 - 192);
  {
    const formats::Uuid uuid = test::golden_uuid();
    const pvb_options options = {static_cast<std::uint32_t>(content.size()), 1, uuid.data()};
    const pvb_channel channels[] = {{"pad", PVB_U8, 1, PVB_PLAIN}, {"file", PVB_U8, 1, PVB_PLAIN}};
    const CFile file(pvb_create(path.c_str(), channels, 2, "{}", &options));
    const unsigned char pad = 0;
    const pvb_array arrays[] = {{&pad, 0}, {content.data(), 1}};
    pvb_append(file.get(), content.size(), arrays);
    pvb_commit(file.get(), nullptr, 0);
    pvb_append(file.get(), content.size(), arrays);  // not committed
    bytes = test::load(path);
  }
  const auto frames = test::frames(bytes);
  REQUIRE(frames.size() == 5);
  bytes[frames[1].offset] = std::byte{0};  // no slot: hop
  bytes[frames[2].offset] = std::byte{0};  // and look at every page of both chunks
  bytes[frames[4].offset] = std::byte{0};
  std::size_t inside = 0;
  for (std::size_t at = frames[4].offset + 4096; at < bytes.size(); at += 4096) {
    inside += std::equal(bytes.begin(), bytes.begin() + 24,
                         bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
  CHECK(inside == inner.bytes.size() / 4096);
  test::save(path, bytes);
  const CFile file(pvb_open(path.c_str()));
  CHECK(file.error().empty());
  CHECK(file.info().records == content.size());
  CHECK(file.info().uncommitted == bytes.size() - frames[4].offset);
}

TEST_CASE("where a base of the index is lost, every chunk is found by looking") {
  const test::Scratch scratch;
  const std::string path = scratch.path("base.pvb");
  {
    const CFile file(test::create_golden(path));
    for (std::size_t pass = 0; pass < 5; ++pass) test::write_golden_pass(file.get(), pass);
  }
  const Bytes whole = test::load(path);
  const auto commits = test::frames(whole, "CMIT"), chunks = test::frames(whole, "CHNK");
  Bytes bytes = whole;
  bytes[commits[2].offset] = std::byte{0};
  bytes[chunks[3].offset] = std::byte{0};  // its place is still in an index
  test::save(path, bytes);
  {
    const CFile file(pvb_open(path.c_str()));
    REQUIRE(file.error().empty());
    CHECK(file.info().records == 5 * test::kGoldenPass);
    CHECK(test::c_read(file.get(), 0, 48, 72) == test::golden_values(0, 48, 72));
    CHECK(test::c_read(file.get(), 0, 0, 40) == test::golden_values(0, 0, 40));
    CHECK(test::c_read(file.get(), 0, 40, 8).empty());
  }
  bytes[commits[1].offset] = std::byte{0};  // the only index that has chunk 3
  test::save(path, bytes);
  const CFile file(pvb_open(path.c_str()));
  CHECK(file.error().find("record 40") != std::string::npos);
}
