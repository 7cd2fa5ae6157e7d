// A row of text a record.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <type_traits>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "export/export.h"
#include "export/file.h"

namespace psf::exports {
namespace {

constexpr std::size_t kRowGrain = 2048;  // rows made at a time by a thread

std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + "\"";
}

// One channel of a batch: `stored`, or `floats` where the stored type is none that C++ prints.
struct Column {
  std::size_t place = 0;
  formats::Type type = formats::Type::f32;
  std::size_t components = 1;
  bool decoded = false;
  std::vector<std::byte> stored;
  std::vector<float> floats;
};

template <class T>
void append(fmt::memory_buffer& out, const void* from, std::size_t index) {
  T value;
  std::memcpy(&value, static_cast<const std::byte*>(from) + index * sizeof(T), sizeof(T));
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(value)) value = std::abs(value);  // the sign of a NaN says nothing
  }
  fmt::format_to(std::back_inserter(out), ",{}", value);
}

void append(fmt::memory_buffer& out, const Column& column, std::size_t record) {
  for (std::size_t c = 0; c < column.components; ++c) {
    const std::size_t index = record * column.components + c;
    if (column.decoded) {
      append<float>(out, column.floats.data(), index);
      continue;
    }
    switch (column.type) {
      case formats::Type::u8:
        append<std::uint8_t>(out, column.stored.data(), index);
        break;
      case formats::Type::u16:
        append<std::uint16_t>(out, column.stored.data(), index);
        break;
      case formats::Type::u32:
        append<std::uint32_t>(out, column.stored.data(), index);
        break;
      case formats::Type::u64:
        append<std::uint64_t>(out, column.stored.data(), index);
        break;
      case formats::Type::f16:
        break;  // decoded
      case formats::Type::f32:
        append<float>(out, column.stored.data(), index);
        break;
      case formats::Type::f64:
        append<double>(out, column.stored.data(), index);
        break;
    }
  }
}

}  // namespace

ExportResult export_csv(const formats::Reader& reader, const ExportSelection& selection,
                        const std::string& path, const ExportProgress& progress) {
  const ExportRecords records(reader, selection);
  const std::vector<std::size_t> channels = records.find_or_all(selection.channels);
  ExportResult outcome;
  outcome.records = outcome.written = records.size();
  outcome.passes = records.passes();
  outcome.files = {path};
  core::OutputFile output(path);
  ExportFile file(output.temporary_path(), path);

  std::vector<Column> columns;
  std::string line = "record,pass";
  std::size_t bytes = 16;
  for (const std::size_t k : channels) {
    const formats::Channel& channel = records.schema().channels[k];
    const bool decoded =
        channel.encoding == formats::Encoding::octahedral || channel.type == formats::Type::f16;
    columns.push_back({k, channel.type, channel.decoded_components(), decoded, {}, {}});
    for (std::size_t c = 0; c < columns.back().components; ++c) {
      line += "," + quoted(component_name(channel, c));
      bytes += 24;  // text of a number
    }
  }
  file.write(line + "\n");
  const std::size_t batch = records.batch(bytes);
  std::vector<fmt::memory_buffer> texts(core::range_count(batch, kRowGrain));
  for (std::uint64_t first = 0; first < records.size(); first += batch) {
    core::throw_if_interrupted("nothing was exported");
    const auto count =
        static_cast<std::size_t>(std::min<std::uint64_t>(batch, records.size() - first));
    for (Column& column : columns) {
      if (column.decoded) {
        records.read_floats(column.place, first, count, column.floats);
      } else {
        records.read(column.place, first, count, column.stored);
      }
    }
    core::parallel_for(count, kRowGrain, [&](std::size_t begin, std::size_t end) {
      fmt::memory_buffer& text = texts[begin / kRowGrain];
      text.clear();
      for (std::size_t i = begin; i < end; ++i) {
        fmt::format_to(std::back_inserter(text), "{},{}", records.record(first + i),
                       records.pass(first + i));
        for (const Column& column : columns) append(text, column, i);
        text.push_back('\n');
      }
    });
    for (std::size_t k = 0; k < core::range_count(count, kRowGrain); ++k) {
      file.write(std::string_view(texts[k].data(), texts[k].size()));
    }
    if (progress) progress(first + count, records.size());
  }
  file.close();
  outcome.bytes = file.bytes();
  output.commit();
  return outcome;
}

}  // namespace psf::exports
