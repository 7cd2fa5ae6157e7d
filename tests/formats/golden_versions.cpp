#include "golden_versions.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "file_bytes.h"
#include "golden.h"

namespace psf::test {
namespace {

// The example with `front` as prefix and directory of HEAD, and the copies in the commits with it.
Bytes with_head(const Bytes& whole, const Bytes& front) {
  Bytes bytes = whole;
  std::copy(front.begin(), front.end(), bytes.begin());
  put(bytes, 56, 4, front.size() - 64);
  mend(bytes, 0);
  for (const FramePlace& commit : frames(whole, "CMIT")) {
    const std::size_t at = commit.offset, copy = get(whole, at + 160, 8);
    const std::size_t old_resume = get(whole, at + 184, 8), resume_size = get(whole, at + 192, 8);
    const std::size_t resume = (copy + front.size() + 63) / 64 * 64;
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    std::fill(begin + static_cast<std::ptrdiff_t>(copy),
              begin + static_cast<std::ptrdiff_t>(commit.length), std::byte{0});
    std::copy_n(bytes.begin(), front.size(), begin + static_cast<std::ptrdiff_t>(copy));
    std::copy_n(whole.begin() + static_cast<std::ptrdiff_t>(at + old_resume), resume_size,
                begin + static_cast<std::ptrdiff_t>(resume));
    put(bytes, at + 168, 8, front.size());
    put(bytes, at + 176, 4, slow_crc(std::span(bytes).subspan(at + copy, front.size())));
    put(bytes, at + 184, 8, resume);
    mend(bytes, at);
  }
  return bytes;
}

Bytes example(const std::string& path) {
  write_example(path);
  return load(path);
}

Bytes front_of(const Bytes& whole) {
  return {whole.begin(), whole.begin() + 64 + static_cast<std::ptrdiff_t>(get(whole, 56, 4))};
}

void append(Bytes& bytes, const std::string& text) {
  const auto more = std::as_bytes(std::span(text));
  bytes.insert(bytes.end(), more.begin(), more.end());
}

}  // namespace

void write_golden_minor(const std::string& path) {
  const Bytes whole = example(path);
  Bytes front = front_of(whole);
  const std::string metadata = R"({"producer":"later","later.key":{"deep":[1,2]}})";
  put(front, 66, 2, 1);            // minor version
  put(front, 72, 4, 0x80000001u);  // optional features
  put(front, 84, 4, metadata.size());
  front.resize(64 + 64 + 2 * 64);
  append(front, metadata);
  append(front, "bytes of version 1.1");
  save(path, with_head(whole, front));
}

void write_golden_major(const std::string& path) {
  const Bytes whole = example(path);
  Bytes front = front_of(whole);
  put(front, 64, 2, 2);
  save(path, with_head(whole, front));
}

void write_golden_required(const std::string& path) {
  const Bytes whole = example(path);
  Bytes front = front_of(whole);
  put(front, 68, 4, 4);
  save(path, with_head(whole, front));
}

void write_golden_swapped(const std::string& path) {
  const Bytes whole = example(path);
  Bytes bytes = whole;
  constexpr std::array<std::array<std::size_t, 2>, 6> kFields = {
      {{28, 4}, {32, 8}, {40, 8}, {48, 8}, {56, 4}, {60, 4}}};
  for (const FramePlace& frame : frames(whole)) {
    for (const auto& [offset, size] : kFields) {
      const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(frame.offset + offset);
      if (offset == 60) {
        Bytes checked(at - 60, at);
        const auto length = static_cast<std::ptrdiff_t>(get(whole, frame.offset + 56, 4));
        checked.insert(checked.end(), at + 4, at + 4 + length);
        put(bytes, frame.offset + 60, 4, slow_crc(checked));
      }
      std::reverse(at, at + static_cast<std::ptrdiff_t>(size));
    }
  }
  save(path, bytes);
}

}  // namespace psf::test
