// The reader of the C header: the golden files, ranges into strides, and what it refuses.
#include <cstring>

#include "c_file.h"
#include "catch.h"
#include "formats/layout/head.h"
#include "golden.h"

using namespace psf;
using test::CFile;

namespace {

const std::string kData = PSF_SOURCE_DIR "/sample_data/";

}  // namespace

TEST_CASE("the golden files of the C++ writer are read with the same values") {
  const formats::Head head = test::golden_head();
  for (const std::string name : {"golden-raw.pvb", "golden-tail.pvb"}) {
    CAPTURE(name);
    const CFile file(pvb_open((kData + name).c_str()));
    REQUIRE(file.error().empty());
    const pvb_info& info = file.info();
    CHECK(info.records == test::kGoldenRecords);
    CHECK(info.passes == test::kGoldenPasses);
    CHECK((info.closed != 0) == (name == "golden-raw.pvb"));
    CHECK((info.uncommitted > 0) == (name == "golden-tail.pvb"));
    CHECK(info.chunk_capacity == test::kGoldenCapacity);
    CHECK(std::string(info.metadata, info.metadata_size) == head.metadata);
    REQUIRE(info.state != nullptr);
    CHECK(std::string(static_cast<const char*>(info.state), info.state_size) == "resume 1");
    for (std::uint64_t pass = 0; pass < 2; ++pass) {
      std::uint64_t first = 0, count = 0;
      CHECK(pvb_pass(file.get(), pass, &first, &count) == 0);
      CHECK(first == pass * test::kGoldenPass);
      CHECK(count == test::kGoldenPass);
    }
    REQUIRE(info.channel_count == head.channels.size());
    for (std::size_t k = 0; k < info.channel_count; ++k) {
      CHECK(info.channels[k].name == head.channels[k].name);
      CHECK(info.channels[k].type == static_cast<int>(head.channels[k].type));
      CHECK(info.channels[k].components == head.channels[k].components);
      CHECK(info.channels[k].encoding == static_cast<int>(head.channels[k].encoding));
      CHECK(pvb_find(file.get(), info.channels[k].name) == static_cast<int>(k));
    }
    CHECK(pvb_find(file.get(), "nothing") == -1);
    CHECK(test::golden_faults(kData + name, test::kGoldenRecords) == "");
  }
}

TEST_CASE("any range of any channel, into any stride") {
  const formats::Head head = test::golden_head();
  const CFile file(pvb_open((kData + "golden-raw.pvb").c_str()));
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < head.channels.size(); ++k) {
    const std::size_t size = head.channels[k].stride(), stride = size + 3;
    for (std::size_t first = 0; first <= test::kGoldenRecords; ++first) {
      for (std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{15}, std::size_t{30}}) {
        count = std::min(count, test::kGoldenRecords - first);
        test::Bytes out(count * stride, std::byte{0xEE}), expected = out;
        const test::Bytes values = test::golden_values(k, first, count);
        for (std::size_t i = 0; i < count; ++i) {
          std::memcpy(&expected[i * stride], &values[i * size], size);
        }
        wrong += pvb_read(file.get(), k, first, count, out.data(), stride) != 0;
        wrong += out != expected;
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("compressed columns name the channel and the remedy") {
  const CFile file(pvb_open((kData + "golden-zstd.pvb").c_str()));
  REQUIRE(file.error().empty());
  const auto flags = static_cast<std::size_t>(pvb_find(file.get(), "throughput"));
  std::size_t compressed = 0;
  for (std::size_t k = 0; k < file.info().channel_count; ++k) {
    const test::Bytes values = test::c_read(file.get(), k, 0, 16);
    if (values == test::golden_values(k, 0, 16)) continue;  // zstd did not make it smaller
    ++compressed;
    CHECK(values.empty());
    CHECK(file.error().find("chunk 0 (records 0-15), channel ") != std::string::npos);
    CHECK(file.error().find(file.info().channels[k].name) != std::string::npos);
    CHECK(file.error().find("psf cat --codec raw") != std::string::npos);
  }
  CHECK(compressed > 0);
  CHECK(flags < file.info().channel_count);
}

TEST_CASE("a wrong call is an error of its own, and the next call works") {
  const CFile file(pvb_open((kData + "golden-raw.pvb").c_str()));
  std::uint64_t first = 0, count = 0;
  float out[6] = {};
  CHECK(pvb_read(file.get(), 19, 0, 1, out, 12) == PVB_USAGE);
  CHECK(pvb_read(file.get(), 0, 47, 2, out, 12) == PVB_USAGE);
  CHECK(pvb_read(file.get(), 0, ~std::uint64_t{0}, 2, out, 12) == PVB_USAGE);
  CHECK(pvb_read(file.get(), 0, 1, ~std::size_t{0}, out, 12) == PVB_USAGE);
  CHECK(pvb_read(file.get(), 0, 0, 2, out, 11) == PVB_USAGE);
  CHECK(pvb_read(file.get(), 0, 0, 2, nullptr, 12) == PVB_USAGE);
  CHECK(pvb_pass(file.get(), 2, &first, &count) == PVB_USAGE);
  CHECK(pvb_commit(file.get(), nullptr, 0) == PVB_USAGE);
  CHECK(pvb_read(file.get(), 0, 48, 0, nullptr, 0) == 0);
  CHECK(pvb_read(file.get(), 0, 0, 2, out, 12) == 0);
  CHECK(file.error().empty());
}

TEST_CASE("what is no path-vertex buffer of version 1 with a commit is refused") {
  const test::Scratch scratch;
  const std::string path = scratch.path("x.pvb");
  const auto error = [&] { return CFile(pvb_open(path.c_str())).error(); };
  CHECK(error().find("check the name") != std::string::npos);
  const test::Bytes whole = test::load(kData + "golden-raw.pvb");
  const auto changed = [&](const auto& change) {
    test::Bytes bytes = whole;
    change(bytes);
    test::save(path, bytes);
    return error();
  };
  using test::Bytes;
  CHECK(changed([](Bytes& b) { b.clear(); }).find("no path-vertex") != std::string::npos);
  CHECK(changed([](Bytes& b) { b[0] = std::byte{'P'}; }).find("no path-v") != std::string::npos);
  CHECK(changed([](Bytes& b) { b.resize(8192); }).find("no committed pass") != std::string::npos);
  CHECK(changed([](Bytes& b) {
          test::put(b, 64, 2, 2);
          test::mend(b, 0);
        }).find("version 2.0") != std::string::npos);
  CHECK(changed([](Bytes& b) {
          test::put(b, 68, 4, 4);
          test::mend(b, 0);
        }).find("newer") != std::string::npos);
  CHECK(changed([](Bytes& b) {
          test::put(b, 66, 2, 9);  // minor version and optional features: read on
          test::put(b, 72, 4, 1);
          test::mend(b, 0);
        }).empty());
  CHECK(changed([](Bytes& b) {  // a frame that must be understood
          const std::size_t at = test::frames(b).at(2).offset;
          test::put(b, at + 24, 4, 0x21212121);
          test::mend(b, at);
          const std::size_t slot = test::frames(b).at(1).offset;
          test::put(b, slot, 1, 0);
        })
            .find("newer pvb.h") != std::string::npos);
  CHECK(changed([](Bytes& b) {  // one that need not
          const std::size_t at = b.size();
          Bytes page(b.begin() + 4096, b.begin() + 8192);
          b.insert(b.end(), page.begin(), page.end());
          test::put(b, at + 24, 4, 0x21212121);
          test::put(b, at + 32, 8, at);
          test::mend(b, at);
        })
            .empty());
}
