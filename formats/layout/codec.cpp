#include "formats/layout/codec.h"

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <new>

#include "core/error.h"
#include "formats/layout/crc.h"

namespace psf::formats {
namespace {

// The level of zstd. Measured on 262,144 records of the Cornell box after the shuffle, one thread:
// level 1
// packs 1.6 GB/s to 0.284 and unpacks 2.0 GB/s, -1 packs 2.6 to 0.307 and unpacks 2.75, -4
// packs 2.9 to 0.314. A dump is written in the renderer's time and read many times. Writing costs a
// render 6.5% in the Cornell box, whose paths take 1.4 us each (10.5% with level 1), and 4.5% in
// Sponza: nearly half of it is zstd, a quarter the shuffle, which waits for the other core's cache,
// a fifth the system's copy.
constexpr int kLevel = -1;

struct ContextDeleter {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

// Contexts and scratch of one thread: making them costs more than a small column.
struct Scratch {
  std::unique_ptr<ZSTD_CCtx, ContextDeleter> compressor;
  std::unique_ptr<ZSTD_DCtx, ContextDeleter> decompressor;
  Buffer shuffled;
};

Scratch& scratch() {
  thread_local Scratch instance;
  return instance;
}

// Before the scratch grows: several frames in a row are no column, and what says its own size has
// to say this one.
void check_frame(std::span<const std::byte> stored, std::size_t size) {
  const unsigned long long told = ZSTD_getFrameContentSize(stored.data(), stored.size());
  if (ZSTD_findFrameCompressedSize(stored.data(), stored.size()) != stored.size() ||
      (told != ZSTD_CONTENTSIZE_UNKNOWN && told != size)) {
    throw Error(ErrorCode::bad_input, "is not one Zstandard frame of the size of its records");
  }
}

void unpack(std::span<const std::byte> stored, std::span<std::byte> out) {
  Scratch& mine = scratch();
  if (!mine.decompressor) mine.decompressor.reset(ZSTD_createDCtx());
  if (!mine.decompressor) throw std::bad_alloc();
  const std::size_t size = ZSTD_decompressDCtx(mine.decompressor.get(), out.data(), out.size(),
                                               stored.data(), stored.size());
  if (ZSTD_isError(size) != 0 || size != out.size()) {
    throw Error(ErrorCode::bad_input, "does not decode to the size of its records");
  }
}

}  // namespace

std::span<std::byte> Buffer::get(std::size_t size) {
  if (size > capacity_) {
    data_.reset();
    data_ = std::make_unique_for_overwrite<std::byte[]>(size);
    capacity_ = size;
  }
  return {data_.get(), size};
}

void shuffle4(std::span<const std::byte> in, std::span<std::byte> out) {
  const std::size_t words = in.size() / 4;
  const std::byte* from = in.data();
  std::byte* const a = out.data();
  std::byte* const b = a + words;
  std::byte* const c = b + words;
  std::byte* const d = c + words;
  for (std::size_t k = 0; k < words; ++k) {
    std::uint32_t word = 0;
    std::memcpy(&word, from + 4 * k, 4);
    a[k] = static_cast<std::byte>(word);
    b[k] = static_cast<std::byte>(word >> 8);
    c[k] = static_cast<std::byte>(word >> 16);
    d[k] = static_cast<std::byte>(word >> 24);
  }
  std::copy(in.begin() + static_cast<std::ptrdiff_t>(4 * words), in.end(),
            out.begin() + static_cast<std::ptrdiff_t>(4 * words));
}

void unshuffle4(std::span<const std::byte> in, std::span<std::byte> out) {
  const std::size_t words = in.size() / 4;
  const std::byte* const a = in.data();
  const std::byte* const b = a + words;
  const std::byte* const c = b + words;
  const std::byte* const d = c + words;
  std::byte* to = out.data();
  // Byte by byte, which compilers make interleaved stores of: words put together take 2.6 times as
  // long.
  for (std::size_t k = 0; k < words; ++k, to += 4) {
    to[0] = a[k];
    to[1] = b[k];
    to[2] = c[k];
    to[3] = d[k];
  }
  std::copy(in.begin() + static_cast<std::ptrdiff_t>(4 * words), in.end(),
            out.begin() + static_cast<std::ptrdiff_t>(4 * words));
}

EncodedColumn encode_column(Codec wanted, std::span<const std::byte> raw, Buffer& storage) {
  if (wanted == Codec::zstd && raw.size() > 1) {
    Scratch& mine = scratch();
    if (!mine.compressor) mine.compressor.reset(ZSTD_createCCtx());
    if (!mine.compressor) throw std::bad_alloc();
    const std::span<std::byte> shuffled = mine.shuffled.get(raw.size());
    shuffle4(raw, shuffled);
    // One byte less than raw: what does not fit is not worth it.
    const std::span<std::byte> out = storage.get(raw.size() - 1);
    const std::size_t size = ZSTD_compressCCtx(mine.compressor.get(), out.data(), out.size(),
                                               shuffled.data(), shuffled.size(), kLevel);
    if (ZSTD_isError(size) == 0) {
      const std::span<const std::byte> bytes = out.first(size);
      return {Codec::zstd, Filter::shuffle4, crc32(bytes), bytes};
    }
  }
  return {Codec::raw, Filter::none, crc32(raw), raw};
}

void decode_zstd(std::span<const std::byte> stored, Filter filter, std::span<std::byte> out) {
  check_frame(stored, out.size());
  const bool shuffled = filter == Filter::shuffle4;
  const std::span<std::byte> target = shuffled ? scratch().shuffled.get(out.size()) : out;
  unpack(stored, target);
  if (shuffled) unshuffle4(target, out);
}

bool decodes_to_zeros(std::span<const std::byte> stored, std::size_t size) {
  check_frame(stored, size);
  if (size == 0) return true;
  const std::span<std::byte> bytes = scratch().shuffled.get(size);
  unpack(stored, bytes);
  return bytes[0] == std::byte{0} && std::memcmp(bytes.data(), bytes.data() + 1, size - 1) == 0;
}

}  // namespace psf::formats
