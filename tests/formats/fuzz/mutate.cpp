#include "mutate.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "formats/layout/crc.h"
#include "formats/layout/layout.h"

namespace psf::fuzz {
namespace {

using formats::kPage;
using formats::kPrefix;
using Any = std::size_t (*)(std::uint8_t*, std::size_t, std::size_t);
using Page = std::span<std::uint8_t>;

template <class T>
T load(const std::uint8_t* from) {
  T value = 0;
  std::memcpy(&value, from, sizeof value);
  return value;
}

template <class T>
void store(std::uint8_t* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

std::uint32_t crc(std::span<const std::uint8_t> bytes) {
  return formats::crc32(std::as_bytes(bytes));
}

// The checksum at `to` of `length` bytes at `offset`, where they are there.
void mend_part(std::span<const std::uint8_t> frame, std::uint8_t* to, std::uint64_t offset,
               std::uint64_t length) {
  if (offset > frame.size() || length > frame.size() - offset) return;
  store(to, crc(frame.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length))));
}

// Checksums within the data of the frame that starts at `frame`, then that of its front.
void mend_frame(std::span<std::uint8_t> frame) {
  const std::size_t directory = load<std::uint32_t>(&frame[56]);
  if (directory > frame.size() - kPrefix) return;
  const auto type = load<std::uint32_t>(&frame[24]);
  if (type == formats::kChunkType) {
    for (std::size_t at = 96; at + 24 <= kPrefix + directory; at += 24) {
      mend_part(frame, &frame[at + 4], load<std::uint64_t>(&frame[at + 8]),
                load<std::uint64_t>(&frame[at + 16]));
    }
  } else if (type == formats::kCommitType) {
    for (std::size_t at = 136; at + 24 <= kPrefix + directory && at < 208; at += 24) {
      mend_part(frame, &frame[at + 16], load<std::uint64_t>(&frame[at]),
                load<std::uint64_t>(&frame[at + 8]));
    }
  } else if (type == formats::kSlotType && frame.size() >= kPage) {
    for (const std::size_t at : {formats::kSlotFirst, formats::kSlotSecond}) {
      if (load<std::uint64_t>(&frame[at]) != 0) store(&frame[at + 28], crc(frame.subspan(at, 28)));
    }
  }
  const std::uint32_t front = crc(frame.first(kPrefix - 4));
  store(&frame[kPrefix - 4],
        formats::crc32(front, std::as_bytes(frame.subspan(kPrefix, directory))));
}

class Mutation {
 public:
  Mutation(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed, Any any)
      : data_(data), size_(size), most_(most), random_(seed), any_(any) {}

  std::size_t run() {
    const std::size_t what = pick(16);
    if (size_ < 2 * kPage || what == 0) return any_(data_, size_, most_);
    if (what < 4) {
      move_pages();
    } else if (what < 8) {
      set_field();
    } else {
      change_bytes();
    }
    // One in eight stays as damage leaves it.
    if (pick(8) != 0) mend(pick(2) == 0);
    return size_;
  }

 private:
  std::size_t pick(std::size_t count) { return random_() % std::max<std::size_t>(count, 1); }
  std::size_t pages() const { return size_ / kPage; }
  Page page(std::size_t k) { return {data_ + k * kPage, std::min(kPage, size_ - k * kPage)}; }

  void move_pages() {
    const std::size_t from = pick(pages()), to = pick(pages()), count = 1 + pick(3);
    const std::size_t length = std::min(count * kPage, size_ - std::max(from, to) * kPage);
    switch (pick(5)) {
      case 0:
        std::memset(data_ + to * kPage, 0, length);
        break;
      case 1:
        std::memmove(data_ + to * kPage, data_ + from * kPage, length);
        break;
      case 2:
        std::memmove(data_ + to * kPage, data_ + to * kPage + length, size_ - to * kPage - length);
        size_ -= length;
        break;
      case 3: {
        if (length > most_ - size_) break;
        const std::vector<std::uint8_t> copy(data_ + from * kPage, data_ + from * kPage + length);
        std::memmove(data_ + to * kPage + length, data_ + to * kPage, size_ - to * kPage);
        std::memcpy(data_ + to * kPage, copy.data(), length);
        size_ += length;
        break;
      }
      default:
        size_ = pick(4) == 0 ? 1 + pick(size_) : kPage * (1 + pick(pages()));
        break;
    }
  }

  // Up to which byte a page is not all zero, and some more.
  std::size_t used(Page page) {
    std::size_t end = page.size();
    while (end > 0 && page[end - 1] == 0) --end;
    return std::min(end + 8, page.size());
  }

  // A whole field, at a value at which something may go wrong.
  void set_field() {
    const Page at = page(pick(pages()));
    const std::size_t width = std::size_t{1} << pick(4);
    const std::size_t end = used(at) / width;
    if (end == 0) return;
    std::uint8_t* const field = &at[width * pick(end)];
    const std::uint64_t old = load_field(field, width);
    const std::array<std::uint64_t, 12> values = {
        0,       1,           ~std::uint64_t{0},         std::uint64_t{1} << 31,
        old + 1, old - 1,     std::uint64_t{1} << 32,    std::uint64_t{1} << 63,
        size_,   old + kPage, kPage * pick(pages() + 2), std::uint64_t{pick(256)}};
    const std::uint64_t value = values[pick(values.size())];
    std::memcpy(field, &value, width);
  }

  static std::uint64_t load_field(const std::uint8_t* from, std::size_t width) {
    std::uint64_t value = 0;
    std::memcpy(&value, from, width);
    return value;
  }

  void change_bytes() {
    const Page at = page(pick(pages()));
    const std::size_t begin = pick(used(at));
    const std::size_t length = std::min<std::size_t>(1 + pick(64), at.size() - begin);
    std::array<std::uint8_t, 64> part{};
    std::memcpy(part.data(), &at[begin], length);
    const std::size_t changed = any_(part.data(), length, length);
    std::memcpy(&at[begin], part.data(), std::min(changed, length));
  }

  // Checksums, and with `place` the own offsets and the uuid: what a move of pages breaks.
  void mend(bool place) {
    for (std::size_t k = 0; k < pages(); ++k) {
      const Page front = page(k);
      if (front.size() < kPage || std::memcmp(front.data(), formats::kMagic.data(), 8) != 0) {
        continue;
      }
      if (place) {
        std::memcpy(&front[8], data_ + 8, 16);
        store(&front[32], std::uint64_t{k * kPage});
      }
      mend_frame({front.data(), size_ - k * kPage});
    }
  }

  std::uint8_t* data_;
  std::size_t size_, most_;
  std::minstd_rand random_;
  Any any_;
};

}  // namespace

std::size_t mutate_file(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed,
                        Any any) {
  return Mutation(data, size, most, seed, any).run();
}

}  // namespace psf::fuzz
