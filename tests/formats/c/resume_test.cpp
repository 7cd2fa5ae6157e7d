// Resuming through the C header: after any cut, and refused where it must be.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>

#include "c_file.h"
#include "catch.h"
#include "formats/read/reader.h"
#include "formats/write/writer.h"
#include "golden.h"

using namespace psf;
using test::Bytes;
using test::CFile;

namespace {

const std::string kRaw = PSF_SOURCE_DIR "/sample_data/golden-raw.pvb";

std::string state_of(const CFile& file) {
  return {static_cast<const char*>(file.info().state), file.info().state_size};
}

// Opens `path` to go on, with the golden channels or others; the error, empty for none.
std::string resume_error(const std::string& path, const std::vector<pvb_channel>& channels,
                         const std::string& metadata) {
  return CFile(
             pvb_resume(path.c_str(), channels.data(), channels.size(), metadata.c_str(), nullptr))
      .error();
}

}  // namespace

TEST_CASE("stopped after each pass and resumed, closed or not, the records are the same") {
  const test::Scratch scratch;
  const std::string path = scratch.path("r.pvb");
  for (std::size_t pass = 0; pass < 140; ++pass) {  // over two steps of the index
    const CFile file(pass == 0 ? test::create_golden(path) : test::resume_golden(path));
    REQUIRE(file.error().empty());
    CHECK(file.info().records == pass * test::kGoldenPass);
    CHECK(file.info().passes == pass);
    if (pass > 0) CHECK(state_of(file) == "resume " + std::to_string(pass - 1));
    REQUIRE(test::write_golden_pass(file.get(), pass) == 0);
    if (pass % 3 == 1) CHECK(pvb_close(file.get()) == 0);
    if (pass % 3 == 2) test::append_golden(file.get(), 0, 20);  // never committed
  }
  CHECK(test::golden_faults(path, 140 * test::kGoldenPass) == "");
}

TEST_CASE("resumed and closed with nothing added, a closed file keeps its bytes") {
  const test::Scratch scratch;
  const std::string path = scratch.path("n.pvb");
  test::save(path, test::load(kRaw));
  const CFile file(test::resume_golden(path));
  CHECK(file.info().closed == 1);
  CHECK(pvb_close(file.get()) == 0);
  CHECK(test::load(path).size() == test::load(kRaw).size());
  CHECK(test::golden_faults(path, test::kGoldenRecords) == "");
}

TEST_CASE("the uncommitted tail is cut off before anything is added") {
  const test::Scratch scratch;
  const std::string path = scratch.path("tail.pvb");
  Bytes bytes = test::load(PSF_SOURCE_DIR "/sample_data/golden-tail.pvb");
  bytes.resize(bytes.size() + 100000, std::byte{0x89});
  test::save(path, bytes);
  const CFile file(test::resume_golden(path));
  CHECK(file.info().uncommitted > 100000);
  CHECK(pvb_close(file.get()) == 0);
  const CFile closed(pvb_open(path.c_str()));
  CHECK(closed.info().uncommitted == 0);
  CHECK(closed.info().closed == 1);
  CHECK(test::golden_faults(path, test::kGoldenRecords) == "");
}

TEST_CASE("cut anywhere, the file goes on behind its last commit") {
  const test::Scratch scratch;
  const std::string path = scratch.path("c.pvb");
  {
    const CFile file(test::create_golden(path));
    for (std::size_t pass = 0; pass < 4; ++pass) test::write_golden_pass(file.get(), pass);
    pvb_close(file.get());
  }
  const Bytes whole = test::load(path);
  const auto commits = test::frames(whole, "CMIT");
  for (std::size_t size = whole.size(); size > commits[0].offset; size -= 509) {
    const auto end = whole.begin() + static_cast<std::ptrdiff_t>(size);
    const Bytes cut(whole.begin(), end);
    test::save(path, cut);
    std::size_t passes = 0;
    for (std::size_t k = 0; k < 4; ++k) passes += commits[k].offset + commits[k].length <= size;
    if (passes == 0) {
      CHECK(test::CFile(test::resume_golden(path)).error().find("no committed") !=
            std::string::npos);
      CHECK(test::load(path) == cut);
      continue;
    }
    {
      const CFile file(test::resume_golden(path));
      REQUIRE(file.error().empty());
      REQUIRE(file.info().passes == passes);
      // So many that the file grows past all that the old slot records named.
      for (std::size_t pass = passes; pass < 7; ++pass) test::write_golden_pass(file.get(), pass);
      if (size % 2 == 0) pvb_close(file.get());
    }
    REQUIRE(test::golden_faults(path, 7 * test::kGoldenPass) == "");
    const Bytes now = test::load(path);  // what was committed has kept its bytes
    REQUIRE(std::equal(whole.begin() + 8192,
                       whole.begin() + static_cast<std::ptrdiff_t>(commits[passes - 1].offset +
                                                                   commits[passes - 1].length),
                       now.begin() + 8192));
  }
}

TEST_CASE("a file that was cut and grew to less than before makes no false promise") {
  const test::Scratch scratch;
  const std::string path = scratch.path("p.pvb");
  {
    const CFile file(test::create_golden(path));
    for (std::size_t pass = 0; pass < 4; ++pass) test::write_golden_pass(file.get(), pass);
  }
  Bytes bytes = test::load(path);
  bytes.resize(test::frames(bytes, "CMIT")[0].offset + 4096);
  test::save(path, bytes);
  {
    const CFile file(test::resume_golden(path));
    // The place that an old record names, of a higher sequence number, lies in this long commit.
    test::append_golden(file.get(), test::kGoldenPass, test::kGoldenPass);
    CHECK(pvb_commit(file.get(), Bytes(60000).data(), 60000) == 0);
  }
  CHECK(CFile(pvb_open(path.c_str())).error().empty());
  CHECK(formats::Reader(path).records() == 2 * test::kGoldenPass);
}

TEST_CASE("other channels, other metadata, damage or a lock: refused, the file unchanged") {
  const test::Scratch scratch;
  const std::string path = scratch.path("u.pvb");
  const formats::Head head = test::golden_head();
  const auto channels = test::c_channels(head);
  const Bytes whole = test::load(PSF_SOURCE_DIR "/sample_data/golden-tail.pvb");
  test::save(path, whole);
  auto other = channels;
  other.pop_back();
  CHECK(resume_error(path, other, head.metadata).find("channel 18") != std::string::npos);
  other = channels;
  other.push_back({"more", PVB_U8, 1, PVB_PLAIN});
  CHECK(resume_error(path, other, head.metadata).find("channel 19") != std::string::npos);
  other = channels;
  other[3].type = PVB_U32;
  CHECK(resume_error(path, other, head.metadata).find("throughput") != std::string::npos);
  other = channels;
  other[15].encoding = PVB_PLAIN;
  CHECK(resume_error(path, other, head.metadata).find("golden.normal") != std::string::npos);
  CHECK(resume_error(path, channels, head.metadata + " ").find("metadata") != std::string::npos);
  CHECK(resume_error(path, channels, "").find("metadata") != std::string::npos);
  std::string changed = head.metadata;
  changed[changed.find("left")] = 'L';
  CHECK(resume_error(path, channels, changed).find("metadata") != std::string::npos);
  CHECK(test::load(path) == whole);

  const int lock = ::open(path.c_str(), O_RDONLY);
  REQUIRE(::flock(lock, LOCK_EX) == 0);
  CHECK(resume_error(path, channels, head.metadata).find("another process") != std::string::npos);
  ::close(lock);
  CHECK(test::load(path) == whole);
  {
    const CFile first(test::resume_golden(path));
    CHECK(first.error().empty());
    CHECK(resume_error(path, channels, head.metadata).find("another proc") != std::string::npos);
  }
  CHECK(test::golden_faults(path, test::kGoldenRecords) == "");

  Bytes damaged = whole;
  damaged[test::frames(whole, "CMIT").back().offset] = std::byte{0};
  test::save(path, damaged);
  CHECK(resume_error(path, channels, head.metadata).find("psf recover") != std::string::npos);
  CHECK(test::load(path) == damaged);
  Bytes minor = whole;
  test::put(minor, 66, 2, 2);
  test::mend(minor, 0);
  test::save(path, minor);
  CHECK(resume_error(path, channels, head.metadata).find("newer") != std::string::npos);
  CHECK(test::load(path) == minor);
  CHECK(resume_error(scratch.path("none"), channels, "{}").find("check the") != std::string::npos);
  CHECK(resume_error(scratch.path(""), channels, "{}").find("none") == std::string::npos);
}

TEST_CASE("a compressed file of the C++ writer is resumed with raw chunks") {
  const test::Scratch scratch;
  const std::string path = scratch.path("z.pvb");
  test::write_golden(path, formats::Codec::zstd);
  {
    const CFile file(test::resume_golden(path));
    REQUIRE(test::write_golden_pass(file.get(), 2) == 0);
  }
  const formats::Reader reader(path);
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    CHECK(test::read_all(reader, k) == test::golden_values(k, 0, 72));
  }
}
