// A damaged EXR is a picture or one line of error, and costs no more than its length allows.
#include <ImfTiledOutputFile.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "counted_memory.h"
#include "exr_samples.h"
#include "film/image.h"
#include "film/picture.h"
#include "read_text.h"
#include "temp_folder.h"

using namespace psf::tests;

namespace {

// Bytes that this process has read from files.
std::uint64_t bytes_read() {
  std::ifstream in("/proc/self/io");
  std::string name;
  std::uint64_t value = 0;
  in >> name >> value;
  return name == "rchar:" ? value : 0;
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// Reads the file both ways and checks what it cost; whether it was a picture.
bool is_picture(const std::string& path, std::size_t size) {
  constexpr std::uint64_t kOpening = 4 << 20;  // what OpenEXR takes for any file
  const std::uint64_t read_before = bytes_read(), allocated_before = allocated_bytes();
  // Empty margin that check_exr() allows any picture.
  constexpr std::uint64_t kMargin = sizeof(psf::Rgb) << 25;
  bool whole = true, shown = false;
  for (const bool all : {false, true}) {
    try {
      if (all) {
        (void)psf::film::read_exr(path);
      } else {
        (void)psf::film::read_picture(path);
        shown = true;
      }
    } catch (const psf::Error& error) {
      whole = false;
      const std::string text = error.what();
      CHECK(text.starts_with(path + ": "));
      CHECK(text.find('\n') == std::string::npos);
      CHECK((error.code() == psf::ErrorCode::bad_input || error.code() == psf::ErrorCode::limit ||
             error.code() == psf::ErrorCode::usage));
    }
  }
  CHECK(bytes_read() - read_before <= 16 * size + kOpening);
  // ZIP gives at most 1032 times its bytes; the planes and the colours hold them once each.
  CHECK(allocated_bytes() - allocated_before <= 4 * 1400 * size + kOpening + (shown ? kMargin : 0));
  return whole;
}

// One change of one file: bits, bytes that mean much, a piece gone, or the end.
std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  // Most of what can go wrong stands in the header and in the table of chunks.
  const std::size_t from =
      below(3) == 0 ? below(bytes.size()) : below(std::min<std::size_t>(bytes.size(), 700));
  switch (below(4)) {
    case 0:
      bytes[from] = static_cast<char>(bytes[from] ^ (1 << below(8)));
      break;
    case 1: {
      constexpr std::uint32_t kOdd[] = {0,          1,       0x7fffffff, 0x80000000,
                                        0xffffffff, 0x10000, 0x1fffffff};
      const std::uint32_t odd = kOdd[below(std::size(kOdd))];
      for (std::size_t k = 0; k < 4 && from + k < bytes.size(); ++k) {
        bytes[from + k] = static_cast<char>((odd >> (8 * k)) & 0xff);
      }
      break;
    }
    case 2:
      bytes.erase(from, 1 + below(64));
      break;
    default:
      bytes.resize(from);
  }
  return bytes;
}

// Replaces the last `count` 4-byte numbers of an attribute's value.
std::string with_numbers(std::string bytes, const std::string& name, std::size_t skip,
                         const std::vector<std::int32_t>& numbers) {
  const std::size_t at = bytes.find(name + '\0' + (name == "tiles" ? "tiledesc" : "box2i") + '\0') +
                         name.size() + (name == "tiles" ? 10 : 7) + 4 + 4 * skip;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    for (std::size_t b = 0; b < 4; ++b) {
      bytes[at + 4 * k + b] =
          static_cast<char>((static_cast<std::uint32_t>(numbers[k]) >> (8 * b)) & 0xff);
    }
  }
  return bytes;
}

void write_tiles(const std::string& path, const Imath::Box2i& window) {
  Imf::Header header = sample_header(window, window, kRgb);
  header.setTileDescription({16, 16, Imf::ONE_LEVEL});
  SamplePixels pixels(window, kRgb);
  Imf::TiledOutputFile file(path.c_str(), header, 0);
  file.setFrameBuffer(pixels.buffer);
  file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
}

}  // namespace

TEST_CASE("a damaged EXR is a picture or one error, and costs what its length allows") {
  const TempFolder folder;
  const std::string path = folder / "a.exr";
  const Imath::Box2i window = box(0, 0, 50, 70);
  std::vector<std::string> sources;
  for (const Imf::Compression compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
        Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION}) {
    write_lines(path, sample_header(window, window, kRgb, compression), kRgb);
    sources.push_back(psf::tests::read_text(path));
  }
  write_tiles(path, window);
  sources.push_back(psf::tests::read_text(path));
  std::mt19937 random(12);
  std::size_t pictures = 0, refused = 0;
  for (const std::string& source : sources) {
    write_bytes(path, source);
    REQUIRE(is_picture(path, source.size()));
    for (int k = 0; k < 300; ++k) {
      const std::string bytes = mutated(source, random);
      INFO("mutation " << k << " of " << source.size() << " bytes");
      write_bytes(path, bytes);
      ++(is_picture(path, bytes.size()) ? pictures : refused);
    }
  }
  // Damage of values alone cannot be seen; most is.
  CHECK(pictures > 100);
  CHECK(refused > 700);
}

TEST_CASE("sizes that a file cannot hold are refused before they cost anything") {
  const TempFolder folder;
  const std::string path = folder / "a.exr";
  const Imath::Box2i window = box(0, 0, 50, 70);
  const auto refused = [&](const std::string& bytes, const std::string& why) {
    write_bytes(path, bytes);
    const std::uint64_t before = allocated_bytes();
    try {
      (void)psf::film::read_picture(path);
      FAIL("was read");
    } catch (const psf::Error& error) {
      INFO(error.what());
      CHECK(std::string(error.what()).find(why) != std::string::npos);
    }
    CHECK(allocated_bytes() - before < (1 << 20));
  };
  write_lines(path, sample_header(window, window, kRgb), kRgb);
  const std::string lines = psf::tests::read_text(path);
  refused(with_numbers(lines, "dataWindow", 0, {0, 0, 20000, 20000}), "do not fit");
  refused(with_numbers(lines, "dataWindow", 0, {0, 0, 0, 0x7ffffffe}), "the most");
  refused(with_numbers(lines, "dataWindow", 0, {0, 0, 0, 100000000}), "do not fit");
  refused(with_numbers(lines, "dataWindow", 0, {1, 0, 0, 0}), "empty");
  refused(with_numbers(lines, "displayWindow", 0, {0, 0, 20000, 20000}), "nearly all empty");
  refused(
      with_numbers(lines, "displayWindow", 0, {-0x7fffffff, -0x7fffffff, 0x7fffffff, 0x7fffffff}),
      "the most");

  write_tiles(path, window);
  const std::string tiles = psf::tests::read_text(path);
  refused(with_numbers(with_numbers(tiles, "tiles", 0, {1, 1}), "dataWindow", 2, {999, 999}),
          "do not fit");
  refused(with_numbers(tiles, "tiles", 0, {0, 0}), "tiles are empty");
}
