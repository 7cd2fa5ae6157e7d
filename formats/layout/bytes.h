// Little-endian encoding into bytes, and decoding by a cursor that cannot read beyond them.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"

namespace psf::formats {

class ByteWriter {
 public:
  template <std::unsigned_integral T>
  void put(T value) {
    for (std::size_t k = 0; k < sizeof(T); ++k) {
      bytes_.push_back(static_cast<std::byte>(value >> (8 * k) & 0xFF));
    }
  }
  void put_bytes(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void put_zeros(std::size_t count) { bytes_.resize(bytes_.size() + count); }

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

// Bytes that cannot be what they are read as.
[[noreturn]] inline void refuse(const std::string& why) {
  throw Error(ErrorCode::bad_input, why);
}

// Decodes bytes one after the other. Throws Error{bad_input} where they end too early.
class ByteReader {
 public:
  // `whose`: whose bytes they are, for the message where they end early; "HEAD's directory ".
  explicit ByteReader(std::span<const std::byte> bytes, const char* whose = "")
      : rest_(bytes), whose_(whose) {}

  template <std::unsigned_integral T>
  [[nodiscard]] T get() {
    const std::span<const std::byte> from = get_bytes(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < sizeof(T); ++k) {
      value |= std::to_integer<std::uint64_t>(from[k]) << (8 * k);
    }
    return static_cast<T>(value);
  }
  [[nodiscard]] std::span<const std::byte> get_bytes(std::size_t count) {
    if (count > rest_.size()) {
      throw Error(ErrorCode::bad_input, std::string(whose_) + "ends early");
    }
    const std::span<const std::byte> front = rest_.first(count);
    rest_ = rest_.subspan(count);
    return front;
  }
  [[nodiscard]] std::span<const std::byte> rest() const { return rest_; }
  void skip(std::size_t count) { static_cast<void>(get_bytes(count)); }

 private:
  std::span<const std::byte> rest_;
  const char* whose_;
};

}  // namespace psf::formats
