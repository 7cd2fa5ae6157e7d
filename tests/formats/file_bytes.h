// A scratch folder, whole files as bytes, and checksums that share no code with the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "formats/read/reader.h"

namespace psf::test {

using Bytes = std::vector<std::byte>;

// A folder of its own that is removed at the end.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }

 private:
  std::string folder_;
};

// Whether `part` is somewhere in `text`.
[[nodiscard]] inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

[[nodiscard]] Bytes load(const std::string& path);
void save(const std::string& path, std::span<const std::byte> bytes);

// Bit by bit, from the definition.
[[nodiscard]] std::uint32_t slow_crc(std::span<const std::byte> bytes);

[[nodiscard]] std::uint64_t get(const Bytes& bytes, std::size_t offset, std::size_t size);
void put(Bytes& bytes, std::size_t offset, std::size_t size, std::uint64_t value);
// Makes the checksum of the frame that starts at `offset` right again.
void mend(Bytes& bytes, std::size_t offset);
// Makes the checksum of the slot record at `offset` right again.
void mend_slot(Bytes& bytes, std::size_t offset);

struct FramePlace {
  std::string type;
  std::size_t offset, length;
};
// The places of the frames in a file without faults.
[[nodiscard]] std::vector<FramePlace> frames(const Bytes& bytes);
[[nodiscard]] std::vector<FramePlace> frames(const Bytes& bytes, const std::string& type);

// Zeroes, copies, swaps, doubles or deletes a page, all of these as often.
void damage_page(Bytes& bytes, std::mt19937& random);

// All records of a channel, as stored.
[[nodiscard]] Bytes read_all(const formats::Reader& reader, std::size_t channel);

}  // namespace psf::test
