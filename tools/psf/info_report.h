// What psf info tells of a file, as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "formats/layout/metadata.h"
#include "formats/read/reader.h"
#include "formats/read/statistics.h"
#include "run/noise_share.h"

namespace psf::tools {

using Statistics = std::vector<std::vector<formats::ComponentStatistics>>;  // by channel

// What is told of the paths, or of a table.
struct TableInfo {
  const formats::TableReader& table;
  std::vector<formats::ChannelSize> sizes;
  Statistics statistics;  // empty unless asked for
};

// The noise shares of each camera, where the file is a dump that can be filtered.
struct Noise {
  std::vector<run::NoiseShare> of;
  std::string unknown;  // the reason why there are no shares
};

// Share of the bytes that are stored; 1 where there are none.
[[nodiscard]] double stored_share(const formats::ChannelSize& size);

void print_overview(const formats::Reader& reader, const formats::Metadata& metadata);
void print_channels(const TableInfo& info);
// Of all components, where they were asked for.
void print_statistics(const TableInfo& info);
void print_noise(const formats::Metadata& metadata, const Noise& noise);

[[nodiscard]] nlohmann::ordered_json describe_file(const formats::Reader& reader,
                                                   const std::vector<TableInfo>& infos);

}  // namespace psf::tools
