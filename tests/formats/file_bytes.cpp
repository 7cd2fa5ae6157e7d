#include "file_bytes.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace psf::test {

Scratch::Scratch() {
  static std::atomic<int> number = 0;
  folder_ = (std::filesystem::temp_directory_path() /
             ("psf-formats-" + std::to_string(::getpid()) + "-" + std::to_string(number++)))
                .string();
  std::filesystem::create_directories(folder_);
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

Bytes load(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

void save(const std::string& path, std::span<const std::byte> bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

std::uint32_t slow_crc(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

std::uint64_t get(const Bytes& bytes, std::size_t offset, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t k = size; k-- > 0;) {
    value = value << 8 | std::to_integer<std::uint64_t>(bytes.at(offset + k));
  }
  return value;
}

void put(Bytes& bytes, std::size_t offset, std::size_t size, std::uint64_t value) {
  for (std::size_t k = 0; k < size; ++k) {
    bytes.at(offset + k) = static_cast<std::byte>(value >> (8 * k) & 0xFF);
  }
}

void mend(Bytes& bytes, std::size_t offset) {
  const std::size_t length = get(bytes, offset + 56, 4);
  if (length > bytes.size() - offset - 64) return;
  const auto frame = bytes.begin() + static_cast<std::ptrdiff_t>(offset);
  Bytes checked(frame, frame + 60);
  checked.insert(checked.end(), frame + 64, frame + 64 + static_cast<std::ptrdiff_t>(length));
  put(bytes, offset + 60, 4, slow_crc(checked));
}

void mend_slot(Bytes& bytes, std::size_t offset) {
  put(bytes, offset + 28, 4, slow_crc(std::span(bytes).subspan(offset, 28)));
}

std::vector<FramePlace> frames(const Bytes& bytes) {
  std::vector<FramePlace> out;
  std::size_t offset = 0;
  while (offset < bytes.size()) {
    std::string type;
    for (std::size_t k = 0; k < 4; ++k) type += static_cast<char>(bytes.at(offset + 24 + k));
    const std::size_t length = get(bytes, offset + 40, 8);
    out.push_back({type, offset, length});
    offset += length;
  }
  return out;
}

std::vector<FramePlace> frames(const Bytes& bytes, const std::string& type) {
  std::vector<FramePlace> out;
  for (const FramePlace& frame : frames(bytes)) {
    if (frame.type == type) out.push_back(frame);
  }
  return out;
}

Bytes read_all(const formats::Reader& reader, std::size_t channel) {
  Bytes out(reader.records() * reader.head().channels.at(channel).stride());
  reader.read(channel, 0, reader.records(), out);
  return out;
}

void damage_page(Bytes& bytes, std::mt19937& random) {
  const auto at = [](std::size_t place) { return static_cast<std::ptrdiff_t>(place); };
  const Bytes before = bytes;
  const std::size_t pages = bytes.size() / 4096;
  const std::size_t a = 4096 * (random() % pages), b = 4096 * (random() % pages);
  const auto copy = [&](std::size_t from, std::size_t to) {
    std::copy_n(before.begin() + at(from), 4096, bytes.begin() + at(to));
  };
  switch (random() % 5) {
    case 0:
      std::fill_n(bytes.begin() + at(a), 4096, std::byte{0});
      break;
    case 1:
      copy(a, b);
      break;
    case 2:  // swapped
      copy(a, b);
      copy(b, a);
      break;
    case 3:  // doubled: everything behind moves
      bytes.insert(bytes.begin() + at(b), before.begin() + at(a), before.begin() + at(a) + 4096);
      break;
    default:
      bytes.erase(bytes.begin() + at(a), bytes.begin() + at(a) + 4096);
      break;
  }
}

}  // namespace psf::test
