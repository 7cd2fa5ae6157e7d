#include "film/exr_check.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>
#include <ImfXdr.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "core/error.h"

namespace psf::film {
namespace {

constexpr int kBytesBeforeHeaders = 8;  // magic number and version

[[noreturn]] void damaged(const std::string& path, const std::string& what) {
  throw Error(ErrorCode::bad_input, path + ": no readable EXR picture: " + what);
}

// Text up to a zero byte.
std::string read_name(std::istream& in, const std::string& path) {
  std::string name;
  std::getline(in, name, '\0');
  if (!in || in.eof()) damaged(path, "its header is cut short");
  return name;
}

// Walks over all attributes, whose declared lengths OpenEXR would allocate before it misses the
// bytes.
void check_lengths(const std::string& path, std::uint64_t size) {
  std::ifstream in(path, std::ios::binary);
  char start[kBytesBeforeHeaders];
  if (!in.read(start, sizeof(start)) || !Imf::isImfMagic(start)) {
    damaged(path, "it does not begin as one does");
  }
  const char* version_bytes = start + 4;
  int version = 0;
  Imf::Xdr::read<Imf::CharPtrIO>(version_bytes, version);
  for (bool any = true; any;) {
    any = false;
    for (std::string name; !(name = read_name(in, path)).empty(); any = true) {
      (void)read_name(in, path);  // its type
      char bytes[4];
      if (!in.read(bytes, sizeof(bytes))) damaged(path, "its header is cut short");
      const char* at = bytes;
      int length = 0;
      Imf::Xdr::read<Imf::CharPtrIO>(at, length);
      const auto place = static_cast<std::uint64_t>(in.tellg());
      if (length < 0 || static_cast<std::uint64_t>(length) > size - place) {
        damaged(path,
                fmt::format("byte {}: attribute {} is said to have {} bytes, more than follow",
                            place, name, length));
      }
      in.seekg(length, std::ios::cur);
    }
    if (!Imf::isMultiPart(version)) return;
  }
}

std::vector<Imf::Header> read_headers(const std::string& path) {
  Imf::StdIFStream in(path.c_str());
  int magic = 0, version = 0;
  Imf::Xdr::read<Imf::StreamIO>(in, magic);
  Imf::Xdr::read<Imf::StreamIO>(in, version);
  if (!Imf::supportsFlags(Imf::getFlags(version)) || Imf::getVersion(version) != Imf::EXR_VERSION) {
    damaged(path, fmt::format("it has version {:#x}, which is none", version));
  }
  std::vector<Imf::Header> headers;
  while (true) {
    Imf::Header header;
    header.readFrom(in, version);
    if (header.readsNothing()) break;
    headers.push_back(std::move(header));
    if (!Imf::isMultiPart(version)) break;
  }
  // A deep picture of one part is told by its type alone, which others need not have.
  if (headers.empty()) damaged(path, "it has no header");
  return headers;
}

std::int64_t lines_of_a_chunk(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
      return 1;
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 32;
  }
}

// How many times more bytes than it has a chunk gives at most: deflate 1032, and PXR24 leaves one
// byte of four out; Huffman's runs of PIZ fewer. DWA deflates what runs of bytes left over.
std::uint64_t most_expansion(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
      return 1;
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return std::uint64_t{1032} * 64;
    default:
      return 1400;
  }
}

std::int64_t parts_of(std::int64_t length, std::int64_t part) {
  return (length + part - 1) / part;
}

struct Extent {
  std::int64_t width, height;
};

Extent extent(const std::string& path, const Imath::Box2i& window, const char* what) {
  const Extent extent = {std::int64_t{window.max.x} - window.min.x + 1,
                         std::int64_t{window.max.y} - window.min.y + 1};
  if (extent.width <= 0 || extent.height <= 0) {
    damaged(path, fmt::format("its {} window is empty", what));
  }
  return extent;
}

void check_size(const std::string& path, const Extent& extent, const char* what) {
  if (extent.width <= kMostPixels / extent.height) return;
  throw Error(ErrorCode::limit,
              fmt::format("{}: its {} window has {} x {} pixels, {} are the most; scale or crop it",
                          path, what, extent.width, extent.height, kMostPixels));
}

bool is_deep(const Imf::Header& header) {
  return header.hasType() && Imf::isDeepData(header.type());
}

// Each chunk has a place in the table of chunks, which is read of every part, and a line number and
// a length of its own.
void check_chunks(const std::string& path, const Imf::Header& header, std::uint64_t size) {
  constexpr std::uint64_t kLeastOfAChunk = 16;
  const Extent data = extent(path, header.dataWindow(), "data");
  std::uint64_t across = 1;
  auto down =
      static_cast<std::uint64_t>(parts_of(data.height, lines_of_a_chunk(header.compression())));
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tiles = header.tileDescription();
    if (tiles.xSize == 0 || tiles.ySize == 0) damaged(path, "its tiles are empty");
    across = static_cast<std::uint64_t>(parts_of(data.width, tiles.xSize));
    down = static_cast<std::uint64_t>(parts_of(data.height, tiles.ySize));
  }
  const std::uint64_t most = size / kLeastOfAChunk;
  if (down <= most && across <= most / down) return;
  damaged(path, fmt::format("{} x {} pixels in chunks do not fit in a file of {} bytes; it is "
                            "damaged or cut short",
                            data.width, data.height, size));
}

// Checks the kind and the size of the pixels of the part that is to be read.
void check_pixels(const std::string& path, const Imf::Header& header, std::uint64_t size) {
  if (is_deep(header)) {
    throw Error(ErrorCode::bad_input,
                path +
                    ": holds deep pixels, several values each; flatten it first, for example "
                    "with oiiotool --flatten");
  }
  const Extent data = extent(path, header.dataWindow(), "data");
  const Extent display = extent(path, header.displayWindow(), "display");
  check_size(path, data, "data");
  check_size(path, display, "display");
  // A picture that is nearly all margin would take memory that its file gives no hint of.
  constexpr std::int64_t kMargin = 1 << 25;
  if (display.width * display.height > kMargin + 16 * data.width * data.height) {
    throw Error(
        ErrorCode::limit,
        fmt::format("{}: its display window of {} x {} pixels is nearly all empty, its data "
                    "window has {} x {}; crop it",
                    path, display.width, display.height, data.width, data.height));
  }
  // Subsampled channels may have few bytes for what others will have to hold.
  std::uint64_t bytes = 2 * static_cast<std::uint64_t>(data.width * data.height);
  std::uint64_t declared = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    const Imf::Channel& one = channel.channel();
    if (one.xSampling < 1 || one.ySampling < 1)
      damaged(path, "its sampling rates are not positive");
    declared +=
        static_cast<std::uint64_t>((data.width / one.xSampling) * (data.height / one.ySampling)) *
        (one.type == Imf::HALF ? 2 : 4);
  }
  bytes = std::max(bytes, declared);
  if (bytes / most_expansion(header.compression()) > size) {
    damaged(path, fmt::format("{} x {} pixels of {} bytes do not fit in a file of {} bytes; it is "
                              "damaged or cut short",
                              data.width, data.height, bytes, size));
  }
}

}  // namespace

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }, ' ');
  return text;
}

void check_exr(const std::string& path) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error || !std::ifstream(path, std::ios::binary)) {
    throw Error(ErrorCode::io,
                path + ": cannot be read: " + (error ? error.message() : std::strerror(errno)));
  }
  check_lengths(path, size);
  const std::vector<Imf::Header> headers = read_headers(path);
  if (headers.size() == 1) check_pixels(path, headers.front(), size);
  for (const Imf::Header& header : headers) check_chunks(path, header, size);
}

void check_part(const std::string& path, const Imf::Header& part) {
  check_pixels(path, part, std::filesystem::file_size(path));
}

}  // namespace psf::film
