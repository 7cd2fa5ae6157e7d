#include "golden.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "formats/layout/metadata.h"
#include "formats/layout/quantize.h"

namespace psf::test {
namespace {

using formats::Channel;
using formats::Encoding;
using formats::Type;

std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

std::uint64_t bits_of(std::size_t channel, std::size_t record, std::size_t component) {
  return mix((channel * 64 + component) * 1000003 + record + 1);
}

// Exact multiples of 1/4096 in [-2, 2), and now and then what is not finite.
float golden_float(std::size_t channel, std::size_t record, std::size_t component) {
  const std::uint64_t bits = bits_of(channel, record, component);
  constexpr std::array<std::uint32_t, 5> kSpecial = {0x7F800000u, 0xFF800000u, 0x7FC00000u,
                                                     0x7FA12345u, 0x80000000u};
  if (bits % 29 == 0) {
    float special = 0;
    std::memcpy(&special, &kSpecial[bits / 29 % kSpecial.size()], 4);
    return special;
  }
  return (static_cast<float>(bits >> 40 & 0x3FFF) - 8192.0f) / 4096.0f;
}

// Axes and other unit vectors that are exact in float.
std::array<float, 3> golden_direction(std::size_t record) {
  constexpr std::array<std::array<float, 3>, 6> kSome = {
      {{0, 0, 1}, {0, -1, 0}, {0.5f, 0.5f, 0.70710677f}, {-0.6f, 0, -0.8f}, {0, 0, 0}, {-1, 0, 0}}};
  return kSome[record % kSome.size()];
}

template <class T>
void store_golden(std::vector<std::byte>& out, T value) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}

void store_record(std::vector<std::byte>& out, const Channel& channel, std::size_t k,
                  std::size_t record) {
  if (channel.encoding == Encoding::octahedral) {
    std::array<std::uint16_t, 2> code{};
    formats::encode_octahedral(golden_direction(record), code);
    store_golden(out, code);
    return;
  }
  for (std::size_t c = 0; c < channel.components; ++c) {
    const std::uint64_t bits = bits_of(k, record, c);
    switch (channel.type) {
      case Type::u8:
        store_golden(out, static_cast<std::uint8_t>(bits % 4));
        break;
      case Type::u16:
        store_golden(out, static_cast<std::uint16_t>(bits % 3));
        break;
      case Type::u32:
        store_golden(out, static_cast<std::uint32_t>(record % 24 * 7 + (bits >> 60)));
        break;
      case Type::u64:
        store_golden(out, bits);
        break;
      case Type::f16:
        store_golden(out, static_cast<std::uint16_t>(bits));
        break;
      case Type::f32:
        store_golden(out, golden_float(k, record, c));
        break;
      case Type::f64:
        store_golden(out, static_cast<double>(golden_float(k, record, c)) / 3);
        break;
    }
  }
}

std::vector<std::byte> read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

void append(formats::Writer& writer, std::size_t first, std::size_t count) {
  std::vector<std::vector<std::byte>> columns;
  std::vector<const void*> pointers;
  for (std::size_t k = 0; k < golden_head().channels.size(); ++k) {
    columns.push_back(golden_values(k, first, count));
  }
  for (const auto& column : columns) pointers.push_back(column.data());
  writer.append(count, pointers);
}

void write_passes(formats::Writer& writer) {
  for (std::size_t pass = 0; pass < kGoldenPasses; ++pass) {
    append(writer, pass * kGoldenPass, kGoldenPass);
    const std::string resume = "resume " + std::to_string(pass);
    writer.commit(std::as_bytes(std::span(resume)));
  }
}

}  // namespace

formats::Head golden_head() {
  formats::Head head;
  head.chunk_capacity = kGoldenCapacity;
  head.channels = {{"position", Type::f32, 3},
                   {"normal", Type::f32, 3},
                   {"reflectance", Type::f32, 3},
                   {"throughput", Type::f32, 3},
                   {"contribution", Type::f32, 3},
                   {"unfiltered", Type::f32, 3},
                   {"distance", Type::f32, 1},
                   {"pixel", Type::u32, 1},
                   {"flags", Type::u8, 1},
                   {"camera", Type::u16, 1},
                   {"visibility", Type::u32, 1},
                   {"hit_distance", Type::f32, 1},
                   {"direction", Type::f32, 3},
                   {"material", Type::u32, 1},
                   {"roughness", Type::f32, 1},
                   {"golden.normal", Type::u16, 2, Encoding::octahedral},
                   {"golden.reflectance", Type::f16, 3},
                   {"golden.number", Type::u64, 1},
                   {"golden.time", Type::f64, 1}};
  formats::Metadata metadata;
  metadata.producer = "psf_make_golden";
  metadata.scene = "none";
  metadata.scene_hash = "0";
  metadata.integrator = "none";
  metadata.sampler = "independent";
  metadata.enumeration = "pixel";
  metadata.vertex_rule = "values by a formula: tests/formats/golden.cpp";
  metadata.units = "scene";
  formats::CameraInfo camera;
  camera.name = "main";
  camera.width = 6;
  camera.height = 4;
  camera.angle_per_pixel = 0.125;
  camera.camera_to_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  camera.projection = camera.camera_to_world;
  metadata.cameras = {camera, camera, camera};
  metadata.cameras[1].name = "left";
  metadata.cameras[2].name = "right";
  metadata.lights = {"lamp", "sky"};
  head.metadata = to_json(metadata);
  return head;
}

std::vector<std::byte> golden_values(std::size_t k, std::size_t first, std::size_t count) {
  static const formats::Head head = golden_head();
  std::vector<std::byte> out;
  for (std::size_t record = first; record < first + count; ++record) {
    store_record(out, head.channels[k], k, record);
  }
  return out;
}

formats::Uuid golden_uuid() {
  return {0x90, 0x1D, 0xE0, 0x00, 0x00, 0x00, 0x40, 0x00, 0x80, 0, 0, 0, 0, 0, 0, 0x01};
}

void write_golden(const std::string& path, formats::Codec codec) {
  formats::Writer writer(path, golden_head(), {codec, false, golden_uuid()});
  write_passes(writer);
  writer.close();
}

void write_golden_tail(const std::string& path) {
  const std::string made = path + ".whole";
  {
    formats::Writer writer(made, golden_head(), {formats::Codec::raw, false, golden_uuid()});
    write_passes(writer);
    append(writer, kGoldenRecords, kGoldenCapacity);
    // Its destructor would cut the tail off.
    std::filesystem::copy_file(made, path, std::filesystem::copy_options::overwrite_existing);
  }
  std::filesystem::remove(made);
}

void write_example(const std::string& path) {
  formats::Head head;
  head.channels = {{"position", Type::f32, 3}, {"flags", Type::u8, 1}};
  head.metadata = R"({"producer":"example"})";
  formats::Uuid uuid;
  for (std::size_t k = 0; k < uuid.size(); ++k) uuid[k] = static_cast<std::uint8_t>(0xA0 + k);
  formats::Writer writer(path, head, {formats::Codec::raw, false, uuid});
  const std::array<float, 9> position = {1, 2, 3, 0.5f, -0.5f, 0.25f, 0, 0, 0};
  const std::array<std::uint8_t, 3> flags = {3, 1, 0};
  const std::array<const void*, 2> columns = {position.data(), flags.data()};
  writer.append(3, columns);
  const std::string resume = "next";
  writer.commit(std::as_bytes(std::span(resume)));
  writer.close();
}

std::string hex_dump(const std::string& path) {
  const std::vector<std::byte> bytes = read_file(path);
  std::string out;
  for (std::size_t row = 0; row < bytes.size(); row += 16) {
    std::string hex, text;
    bool zero = true;
    for (std::size_t k = row; k < row + 16 && k < bytes.size(); ++k) {
      const auto value = std::to_integer<unsigned>(bytes[k]);
      hex += fmt::format(" {:02x}", value);
      text += value > 0x20 && value < 0x7F ? static_cast<char>(value) : '.';
      zero = zero && value == 0;
    }
    if (zero) continue;
    out += fmt::format("{:08x} {}  {}\n", row, hex, text);
  }
  return out;
}

}  // namespace psf::test
