#include "numbered.h"

#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

#include "formats/layout/metadata.h"

namespace psf::test {
namespace {

using formats::Channel;
using formats::Type;

std::uint64_t scatter(std::uint64_t x) {
  x = (x + 1) * 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 29)) * 0xBF58476D1CE4E5B9u;
  return x ^ (x >> 32);
}

float fraction(std::uint64_t number, std::uint64_t salt) {
  return static_cast<float>(scatter(number * 64 + salt) >> 40) / 16777216.0f;
}

// Spread over the sphere.
std::array<float, 3> direction(std::uint64_t number) {
  const float z = 2 * fraction(number, 1) - 1, angle = 6.2831853f * fraction(number, 2);
  const float r = std::sqrt(std::max(0.0f, 1 - z * z));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

float float_value(std::size_t channel, std::uint64_t number, std::size_t component) {
  switch (channel) {
    case 1:
      return static_cast<float>(number % 4096) * 0.25f + static_cast<float>(component);
    case 2:
      return direction(number).at(component);
    case 5: {
      constexpr std::uint32_t kPayload = 0x7FA00123;  // a NaN now and then
      float value = fraction(number, 8 + component) * 7;
      if (number % 97 == 5) std::memcpy(&value, &kPayload, 4);
      return value;
    }
    default:
      return fraction(number, 16 * channel + component);
  }
}

template <class T>
void store(std::vector<std::byte>& out, T value) {
  const auto bytes = std::as_bytes(std::span(&value, 1));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace

formats::Head numbered_head() {
  formats::Head head;
  head.chunk_capacity = kNumberedCapacity;
  head.channels = {{"number", Type::u64, 1},     {"position", Type::f32, 3},
                   {"normal", Type::f32, 3},     {"reflectance", Type::f32, 3},
                   {"throughput", Type::f32, 3}, {"contribution", Type::f32, 3},
                   {"distance", Type::f32, 1},   {"pixel", Type::u32, 1},
                   {"flags", Type::u8, 1},       {"noise", Type::u64, 1}};
  formats::Metadata metadata;
  metadata.producer = "numbered";
  metadata.scene_hash = "5eed";
  metadata.cameras.resize(1);
  metadata.cameras[0].width = 8;
  metadata.cameras[0].height = 5;
  head.metadata = to_json(metadata);
  return head;
}

std::vector<std::byte> numbered_values(std::size_t k, std::span<const std::uint64_t> numbers) {
  static const formats::Head head = numbered_head();
  const Channel& channel = head.channels.at(k);
  std::vector<std::byte> out;
  out.reserve(numbers.size() * channel.stride());
  for (const std::uint64_t number : numbers) {
    if (channel.name == "number") {
      store(out, number);
    } else if (channel.name == "noise") {
      store(out, scatter(number));
    } else if (channel.type == Type::u32) {
      store(out, static_cast<std::uint32_t>(number % kNumberedPass));
    } else if (channel.type == Type::u8) {
      store(out, static_cast<std::uint8_t>(number % 11 == 0 ? 0 : 3));
    } else {
      for (std::size_t c = 0; c < channel.components; ++c) store(out, float_value(k, number, c));
    }
  }
  return out;
}

std::vector<std::uint64_t> numbers_from(std::uint64_t first, std::size_t count) {
  std::vector<std::uint64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

void append_numbered(formats::Writer& writer, std::uint64_t first, std::size_t count) {
  const std::vector<std::uint64_t> numbers = numbers_from(first, count);
  std::vector<std::vector<std::byte>> columns;
  std::vector<const void*> pointers;
  for (std::size_t k = 0; k < writer.head().channels.size(); ++k) {
    columns.push_back(numbered_values(k, numbers));
  }
  for (const auto& column : columns) pointers.push_back(column.data());
  writer.append(count, pointers);
}

std::string numbered_state(std::uint64_t passes) {
  return "pass " + std::to_string(passes);
}

void write_numbered(formats::Writer& writer, std::uint64_t last) {
  while (writer.passes() < last) {
    append_numbered(writer, writer.passes() * kNumberedPass, kNumberedPass);
    const std::string state = numbered_state(writer.passes() + 1);
    writer.commit(std::as_bytes(std::span(state)));
  }
}

void write_numbered_file(const std::string& path, formats::Codec codec, std::uint64_t passes) {
  formats::Writer writer(path, numbered_head(), {codec, false, {}});
  write_numbered(writer, passes);
  writer.close();
}

std::vector<std::uint64_t> numbers_of(const formats::Reader& reader) {
  std::vector<std::uint64_t> numbers(reader.records());
  reader.read(0, 0, numbers.size(), std::as_writable_bytes(std::span(numbers)));
  return numbers;
}

std::size_t wrong_columns(const formats::Reader& reader) {
  const std::vector<std::uint64_t> numbers = numbers_of(reader);
  std::size_t wrong = 0;
  std::vector<std::byte> values;
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    values.resize(numbers.size() * reader.head().channels[k].stride());
    reader.read(k, 0, numbers.size(), values);
    if (values != numbered_values(k, numbers)) ++wrong;
  }
  return wrong;
}

bool holds_passes(const formats::Reader& reader, std::uint64_t passes) {
  if (reader.records() != passes * kNumberedPass || reader.passes().size() != passes) return false;
  for (std::uint64_t k = 0; k < passes; ++k) {
    const formats::Pass& pass = reader.passes()[k];
    if (pass.first != k * kNumberedPass || pass.count != kNumberedPass) return false;
  }
  return numbers_of(reader) == numbers_from(0, passes * kNumberedPass) &&
         wrong_columns(reader) == 0;
}

}  // namespace psf::test
