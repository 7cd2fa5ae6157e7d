#include "bench/dumps.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "core/error.h"
#include "formats/layout/commit.h"
#include "formats/layout/crc.h"
#include "formats/layout/frame.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"
#include "formats/layout/metadata.h"
#include "formats/layout/slot.h"

namespace psf::bench {
namespace {

using formats::Type;

constexpr std::size_t kWidth = 512, kPass = kWidth * kWidth;

formats::Head synthetic_head() {
  formats::Head head;
  head.channels = {{"position", Type::f32, 3},     {"normal", Type::f32, 3},
                   {"reflectance", Type::f32, 3},  {"throughput", Type::f32, 3},
                   {"contribution", Type::f32, 3}, {"unfiltered", Type::f32, 3},
                   {"distance", Type::f32, 1},     {"pixel", Type::u32, 1},
                   {"flags", Type::u8, 1},         {"visibility", Type::u32, 1}};
  formats::Metadata metadata;
  metadata.producer = "psf-bench";
  metadata.cameras.resize(1);
  metadata.cameras[0].width = metadata.cameras[0].height = kWidth;
  head.metadata = formats::to_json(metadata);
  return head;
}

// One pass, a column a channel.
struct Pass {
  std::vector<float> position, normal, reflectance, throughput, contribution, unfiltered, distance;
  std::vector<std::uint32_t> pixel, visibility;
  std::vector<std::uint8_t> flags;

  [[nodiscard]] std::array<const void*, 10> columns() const {
    return {position.data(),     normal.data(),     reflectance.data(), throughput.data(),
            contribution.data(), unfiltered.data(), distance.data(),    pixel.data(),
            flags.data(),        visibility.data()};
  }
};

void push(std::vector<float>& to, float x, float y, float z) {
  to.insert(to.end(), {x, y, z});
}

// From the centre of a cube of side 2, toward -z.
void add_path(Pass& pass, std::uint32_t pixel, std::minstd_rand& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  const auto column = static_cast<float>(pixel % kWidth), row = static_cast<float>(pixel / kWidth);
  constexpr auto kSize = static_cast<float>(kWidth);
  const std::array<float, 3> toward = {2.4f * ((column + unit(random)) / kSize - 0.5f),
                                       2.4f * (0.5f - (row + unit(random)) / kSize), -1};
  const auto wall = static_cast<std::size_t>(
      std::max_element(toward.begin(), toward.end(),
                       [](float a, float b) { return std::abs(a) < std::abs(b); }) -
      toward.begin());
  const float t = 1 / std::abs(toward[wall]);
  std::array<float, 3> n{};
  n[wall] = toward[wall] < 0 ? 1.0f : -1.0f;
  push(pass.position, t * toward[0], t * toward[1], t * toward[2]);
  push(pass.normal, n[0], n[1], n[2]);
  const float shade = n[0] > 0 ? 0.6f : 0.3f;
  push(pass.reflectance, shade, 0.45f, 0.4f);
  push(pass.throughput, 1, 1, 1);
  // A light that is found by chance.
  const float light = unit(random) < 0.3f ? 4 * unit(random) * unit(random) : 0.0f;
  push(pass.contribution, shade * light, 0.45f * light, 0.4f * light);
  push(pass.unfiltered, 0, 0, 0);
  pass.distance.push_back(t * std::hypot(toward[0], toward[1], toward[2]));
  pass.pixel.push_back(pixel);
  pass.flags.push_back(3);
  pass.visibility.push_back(light > 0 ? 1 : 0);
}

void put(int file, const std::string& path, std::uint64_t offset,
         std::span<const std::byte> bytes) {
  if (::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset)) ==
      static_cast<ssize_t>(bytes.size())) {
    return;
  }
  ::close(file);
  throw Error(ErrorCode::io, path +
                                 ": cannot write a file of 200 GB with holes; give another "
                                 "folder with --temp");
}

}  // namespace

void write_synthetic(const std::string& path, std::size_t records, formats::Codec codec) {
  std::minstd_rand random(1);
  formats::Writer writer(path, synthetic_head(), {codec, false, {}});
  for (std::size_t done = 0; done < records; done += kPass) {
    Pass pass;
    const std::size_t count = std::min(kPass, records - done);
    for (std::uint32_t pixel = 0; pixel < count; ++pixel) add_path(pass, pixel, random);
    writer.append(count, pass.columns());
    writer.commit();
  }
  writer.close();
}

void write_copy(const formats::Reader& from, const std::string& path, std::size_t records,
                formats::Codec codec) {
  const formats::Head& head = from.head();
  formats::Writer writer(path, head, {codec, false, {}});
  std::vector<std::vector<std::byte>> columns(head.channels.size());
  std::uint32_t pass = 0;
  std::size_t done = 0;
  for (const formats::ChunkEntry& entry : from.chunks()) {
    if (done >= records) break;
    if (entry.pass != pass) writer.commit();
    pass = entry.pass;
    std::vector<const void*> pointers;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      columns[k].resize(entry.count * head.channels[k].stride());
      from.read(k, entry.first, entry.count, columns[k]);
      pointers.push_back(columns[k].data());
    }
    writer.append(entry.count, pointers);
    done += entry.count;
  }
  writer.commit();
  writer.close();
}

void write_sparse(const std::string& path) {
  constexpr std::uint64_t kChunks = 50000, kLength = std::uint64_t{4} << 20;
  formats::Head head;
  head.channels = {{"value", Type::f32, 15}};
  const std::uint32_t count = head.chunk_capacity;
  const formats::Uuid uuid = formats::make_uuid();
  const auto front = formats::encode_front(
      {uuid, formats::kHeadType, formats::kRequiredFrame, 0, formats::kPage, 0},
      formats::encode_head(head));
  std::vector<formats::ChunkEntry> entries;
  for (std::uint64_t k = 0; k < kChunks; ++k) {
    entries.push_back({2 * formats::kPage + k * kLength, kLength, k * count, count, 0});
  }
  const auto index = formats::encode_index(entries);
  formats::Commit commit;
  commit.flags = formats::kClosed;
  commit.number = commit.passes = 1;
  commit.records = kChunks * count;
  commit.chunks = kChunks;
  commit.index = {0, index.size(), formats::crc32(index)};
  commit.head = {0, front.size(), formats::crc32(front)};
  formats::place_sections(commit);
  const std::uint64_t end = 2 * formats::kPage + kChunks * kLength;
  const formats::Prefix last{uuid, formats::kCommitType,           formats::kRequiredFrame,
                             end,  formats::commit_length(commit), 2 + kChunks};
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) throw Error(ErrorCode::io, path + ": cannot create");
  put(file, path, 0, front);
  put(file, path, formats::kPage,
      formats::encode_front({uuid, formats::kSlotType, 0, formats::kPage, formats::kPage, 1}, {}));
  put(file, path, formats::kPage + formats::slot_record_offset(1),
      formats::encode_slot_record({end, last.length, last.sequence}));
  put(file, path, end, formats::encode_front(last, formats::encode_commit(commit)));
  put(file, path, end + commit.index.offset, index);
  put(file, path, end + commit.head.offset, front);
  const std::byte zero{};
  put(file, path, end + last.length - 1, {&zero, 1});
  ::close(file);
}

}  // namespace psf::bench
