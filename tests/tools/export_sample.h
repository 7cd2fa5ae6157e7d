// A dump for the tests of psf export: every type and encoding, NaN, infinity, records without
// vertex.
#pragma once

#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "formats/read/reader.h"
#include "formats/write/writer.h"

namespace psf::tests {

constexpr std::size_t kPass = 700, kPasses = 3, kRecords = kPass * kPasses;

class Sample {
 public:
  explicit Sample(const std::string& path) : path_(path) {
    formats::Head head;
    head.chunk_capacity = 128;
    head.metadata = R"({"scene":"sample"})";
    head.channels = {{"position", formats::Type::f32, 3},
                     {"normal", formats::Type::u16, 2, formats::Encoding::octahedral},
                     {"contribution", formats::Type::f16, 3},
                     {"throughput", formats::Type::f32, 3},
                     {"unfiltered", formats::Type::f32, 3},
                     {"reflectance", formats::Type::f32, 3},
                     {"distance", formats::Type::f32, 1},
                     {"flags", formats::Type::u8, 1},
                     {"material", formats::Type::u32, 1},
                     {"id", formats::Type::u64, 1},
                     {"time", formats::Type::f64, 1},
                     {"a,\"b\"", formats::Type::u16, 5},
                     {"../x", formats::Type::u8, 1},
                     {".._x", formats::Type::u8, 1}};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<std::vector<std::byte>> columns;
    for (const formats::Channel& channel : head.channels) {
      std::vector<std::byte> column(kRecords * channel.stride());
      for (std::byte& byte : column) byte = static_cast<std::byte>(random());
      if (channel.type == formats::Type::f32) {
        for (std::size_t k = 0; k < column.size(); k += 4) {
          float value = 3 * unit(random) - 1;
          if (random() % 50 == 0) value = random() % 2 == 0 ? NAN : INFINITY;
          std::memcpy(&column[k], &value, 4);
        }
      }
      if (channel.name == "flags") {
        for (std::byte& byte : column) byte = static_cast<std::byte>(random() % 4);
      }
      columns.push_back(std::move(column));
    }
    formats::Writer writer(path, head, {formats::Codec::zstd, false, {}});
    for (std::size_t pass = 0; pass < kPasses; ++pass) {
      std::vector<const void*> parts;
      for (std::size_t k = 0; k < columns.size(); ++k) {
        parts.push_back(columns[k].data() + pass * kPass * head.channels[k].stride());
      }
      writer.append(kPass, parts);
      writer.commit();
    }
    writer.close();
    reader_.emplace(path);
  }

  [[nodiscard]] const formats::Reader& reader() const { return *reader_; }
  [[nodiscard]] std::vector<float> floats(const std::string& name) const {
    const std::size_t k = reader_->head().find(name).value();
    std::vector<float> out(kRecords * reader_->head().channels[k].decoded_components());
    reader_->read_floats(k, 0, kRecords, out);
    return out;
  }
  template <class T>
  [[nodiscard]] std::vector<T> stored(const std::string& name) const {
    const std::size_t k = reader_->head().find(name).value();
    std::vector<T> out(kRecords * reader_->head().channels[k].stride() / sizeof(T));
    reader_->read(k, 0, kRecords, std::as_writable_bytes(std::span(out)));
    return out;
  }

 private:
  std::string path_;
  std::optional<formats::Reader> reader_;
};

inline bool same_number(float a, float b) {
  return std::isnan(a) ? std::isnan(b) : std::bit_cast<unsigned>(a) == std::bit_cast<unsigned>(b);
}

}  // namespace psf::tests
