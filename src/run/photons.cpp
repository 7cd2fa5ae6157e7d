#include "run/photons.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string_view>

#include "core/error.h"
#include "core/parallel.h"
#include "run/table_channel.h"

namespace psf::run {
namespace {

constexpr std::string_view kEstimator = "`estimator density`";

const formats::TableReader& photon_table(const formats::Reader& reader) {
  if (const formats::TableReader* table = reader.find_table("photons")) return *table;
  throw Error(ErrorCode::bad_input,
              fmt::format("{}: has no photons, which {} needs; render with --photons N",
                          reader.path(), kEstimator));
}

std::size_t photon_channel(const formats::Reader& reader, std::string_view name, formats::Type type,
                           std::size_t components) {
  return table_channel(reader, photon_table(reader), name, type, components, kEstimator);
}

// Rows of the table: those of some passes.
struct Rows {
  std::uint64_t first = 0, count = 0;
  std::uint32_t passes = 0;
};

Rows rows_of(const formats::Reader& reader, const filter::PathRange& range) {
  const auto passes = reader.passes(), of_table = photon_table(reader).passes();
  // Passes ascend, and so the first that ends behind the range's beginning is found.
  auto pass =
      static_cast<std::size_t>(std::partition_point(passes.begin(), passes.end(),
                                                    [&](const formats::Pass& p) {
                                                      return p.first + p.count <= range.first;
                                                    }) -
                               passes.begin());
  Rows rows;
  for (; pass < passes.size() && passes[pass].first < range.last; ++pass) {
    if (of_table[pass].count == 0) {
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: pass {} has no photons, which {} needs; choose other passes",
                              reader.path(), pass, kEstimator));
    }
    if (rows.passes == 0) rows.first = of_table[pass].first;
    rows.count += of_table[pass].count;
    ++rows.passes;
  }
  return rows;
}

}  // namespace

std::optional<PhotonChannels> photon_channels(const formats::Reader& reader,
                                              const filter::Parameters& parameters) {
  if (!filter::info(parameters.estimator).is_of_photons) return std::nullopt;
  const auto three = [&](std::string_view name) {
    return photon_channel(reader, name, formats::Type::f32, 3);
  };
  PhotonChannels channels{three("position"), three("normal"), three("direction"), three("power"),
                          std::nullopt};
  if (parameters.weights.material) {
    channels.material = photon_channel(reader, "material", formats::Type::u32, 1);
  }
  return channels;
}

void read_photons(const formats::Reader& reader, const PhotonChannels& channels,
                  const filter::PathRange& range, PhotonColumns& out) {
  const formats::TableReader& table = photon_table(reader);
  const Rows rows = rows_of(reader, range);
  // The filter takes both as one set.
  if (rows.count > filter::kMostPaths || rows.count + range.size() > filter::kMostPaths) {
    throw Error(
        ErrorCode::limit,
        fmt::format("{}: {} photons and {} paths are more than a block may have, {}; give a "
                    "smaller `block`",
                    reader.path(), rows.count, range.size(), filter::kMostPaths));
  }
  const auto count = static_cast<std::size_t>(rows.count);
  out.passes = rows.passes;
  std::vector<std::function<void()>> tasks;
  const auto read = [&](std::size_t place, auto& column) {
    tasks.push_back([&table, &rows, &column, place, count] {
      column.resize(count);
      table.read_floats(place, rows.first, count, {&column[0].x, 3 * count});
    });
  };
  read(channels.position, out.position);
  read(channels.normal, out.normal);
  read(channels.direction, out.direction);
  read(channels.power, out.power);
  out.material.resize(channels.material ? count : 0);
  if (channels.material) {
    tasks.push_back([&table, &rows, &out, place = *channels.material, count] {
      table.read(place, rows.first, count, std::as_writable_bytes(std::span(out.material)));
    });
  }
  core::parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t) { tasks[begin](); });
}

std::uint64_t count_photons(const formats::Reader& reader, const filter::PathRange& range) {
  return rows_of(reader, range).count;
}

std::uint64_t photon_bytes(const PhotonChannels& channels) {
  return 3 * sizeof(Vec3) + sizeof(Rgb) + (channels.material ? sizeof(std::uint32_t) : 0);
}

}  // namespace psf::run
