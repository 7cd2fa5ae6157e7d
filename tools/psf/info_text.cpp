// What psf info tells, as text.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "info_report.h"
#include "info_tables.h"
#include "noise_report.h"

namespace psf::tools {
namespace {

// 1234567 -> "1,234,567"
std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (auto k = static_cast<std::ptrdiff_t>(text.size()) - 3; k > 0; k -= 3) {
    text.insert(static_cast<std::size_t>(k), ",");
  }
  return text;
}

std::string bytes(std::uint64_t count) {
  if (count < 1000) return fmt::format("{} B", count);
  double value = static_cast<double>(count);
  const char* unit = "";
  for (const char* next : {"kB", "MB", "GB", "TB"}) {
    if (value < 999.5) break;
    value /= 1000;
    unit = next;
  }
  return fmt::format("{:.{}f} {}", value, value < 99.95 ? 1 : 0, unit);
}

std::string type_text(const formats::Channel& channel) {
  std::string text(name_of(channel.type));
  if (channel.components > 1) text += fmt::format(" x {}", channel.components);
  if (channel.encoding == formats::Encoding::octahedral) text += " oct";
  return text;
}

std::string codec_text(const formats::ChannelSize& size) {
  if (size.zstd_columns == 0) return "raw";
  return size.raw_columns == 0
             ? "zstd"
             : fmt::format("zstd, raw in {} of {} chunks", grouped(size.raw_columns),
                           grouped(size.raw_columns + size.zstd_columns));
}

std::string passes_text(const formats::Reader& reader) {
  const auto passes = reader.passes();
  const bool even = std::all_of(passes.begin(), passes.end(),
                                [&](const auto& pass) { return pass.count == passes[0].count; });
  if (passes.size() == 1) return "1 pass";
  return fmt::format("{} passes{}", grouped(passes.size()),
                     even && !passes.empty() ? " of " + grouped(passes[0].count) : "");
}

void line(const char* name, const std::string& value) {
  fmt::print("  {:<12}{}\n", name, value);
}

// The width of the column with the channels' names.
std::size_t name_width(const formats::Schema& schema) {
  std::size_t width = 14;
  for (const formats::Channel& channel : schema.channels) {
    width = std::max(width, channel.name.size());
  }
  return width;
}

// A blank line, and before what is of a table its name.
void print_title(const formats::TableReader& table) {
  fmt::print("\n");
  if (table.name() == formats::kPaths) return;
  line("table", fmt::format("{}: {} records, {} chunk{}", table.name(), grouped(table.records()),
                            grouped(table.chunks().size()), table.chunks().size() == 1 ? "" : "s"));
}

}  // namespace

double stored_share(const formats::ChannelSize& size) {
  return size.raw == 0 ? 1 : static_cast<double>(size.stored) / static_cast<double>(size.raw);
}

void print_overview(const formats::Reader& reader, const formats::Metadata& metadata) {
  const formats::Head& head = reader.head();
  fmt::print("{}: path-vertex buffer {}.{}, {}\n", reader.path(), head.major, head.minor,
             reader.closed() ? "closed" : "not closed (being written, or its writer was stopped)");
  line("producer", shown_or_dash(metadata.producer));
  line("scene",
       shown_or_dash(metadata.scene) +
           (metadata.scene_hash.empty() ? "" : ", hash " + shown_or_dash(metadata.scene_hash)));
  line("paths", fmt::format("{}, {} sampler by {}, seed {}, block base {}, split {}",
                            shown_or_dash(metadata.integrator), shown_or_dash(metadata.sampler),
                            shown_or_dash(metadata.enumeration), metadata.seed, metadata.block_base,
                            metadata.split));
  line("vertex", shown_or_dash(metadata.vertex_rule));
  line("units", shown_or_dash(metadata.units));
  line("uuid", reader.uuid());
  line("records",
       fmt::format("{} in {}, {} chunk{}", grouped(reader.records()), passes_text(reader),
                   grouped(reader.chunks().size()), reader.chunks().size() == 1 ? "" : "s"));
  if (metadata.frames) {
    const formats::FrameInfo& frames = *metadata.frames;
    line("frames", fmt::format("{}:{}, {} {} each{}", frames.first,
                               frames.first + std::uint64_t{frames.count}, frames.passes,
                               frames.passes == 1 ? "pass" : "passes",
                               frames.cameras.empty() ? "" : ", cameras that move"));
  }
  line("file", bytes(reader.file_bytes()) + (reader.uncommitted_bytes() == 0
                                                 ? ""
                                                 : fmt::format(", of which {} are not committed",
                                                               bytes(reader.uncommitted_bytes()))));
}

void print_channels(const TableInfo& info) {
  const auto& [table, sizes, statistics] = info;
  constexpr const char* kRow = "  {:<{}} {:<11}{:>9}{:>10}{:>7}  {}\n";
  const std::size_t width = name_width(table.schema());
  print_title(table);
  fmt::print(kRow, "channel", width, "type", "raw", "stored", "ratio", "codec");
  formats::ChannelSize total;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const formats::Channel& channel = table.schema().channels[k];
    fmt::print(kRow, channel.name, width, type_text(channel), bytes(sizes[k].raw),
               bytes(sizes[k].stored), fmt::format("{:.2f}", stored_share(sizes[k])),
               codec_text(sizes[k]));
    total.raw += sizes[k].raw;
    total.stored += sizes[k].stored;
  }
  fmt::print(kRow, "all", width, fmt::format("{} B/record", table.schema().stride()),
             bytes(total.raw), bytes(total.stored), fmt::format("{:.2f}", stored_share(total)), "");
}

void print_statistics(const TableInfo& info) {
  const auto& [table, sizes, statistics] = info;
  constexpr const char* kRow = "  {:<{}} {:>3}{:>14}{:>14}{:>14}{:>12}\n";
  const std::size_t width = name_width(table.schema());
  print_title(table);
  fmt::print(kRow, "channel", width, "", "min", "max", "mean", "non-finite");
  for (std::size_t k = 0; k < statistics.size(); ++k) {
    for (std::size_t c = 0; c < statistics[k].size(); ++c) {
      const formats::ComponentStatistics& of = statistics[k][c];
      const auto number = [&](double value) {
        return of.finite == 0 ? std::string("-") : fmt::format("{:.6g}", value);
      };
      fmt::print(kRow, c == 0 ? table.schema().channels[k].name : "", width,
                 statistics[k].size() > 1 ? std::to_string(c) : "", number(of.min), number(of.max),
                 number(of.mean()), grouped(of.non_finite));
    }
  }
}

void print_noise(const formats::Metadata& metadata, const Noise& noise) {
  fmt::print("\n");
  if (noise.of.empty()) return line("noise", "not known: " + shown_or_dash(noise.unknown));
  fmt::print("  {:<14}{}\n", "camera", "u's share of the noise, which no filter of c reaches");
  for (std::size_t k = 0; k < noise.of.size(); ++k) {
    fmt::print("  {:<14}{}\n", shown_or_dash(metadata.cameras[k].name), share_text(noise.of[k]));
  }
}

}  // namespace psf::tools
