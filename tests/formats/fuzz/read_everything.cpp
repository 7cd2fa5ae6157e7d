#include "read_everything.h"

#include <algorithm>
#include <span>

#include "targets.h"

namespace psf::fuzz {
namespace {

// A chunk of 64 kB may decode to a GiB, which no run has the time for.
constexpr std::uint64_t kMostBytes = 1u << 20;  // a column

bool has_floats(const formats::Channel& channel) {
  return channel.encoding == formats::Encoding::octahedral || channel.type == formats::Type::f16 ||
         channel.type == formats::Type::f32 || channel.type == formats::Type::f64;
}

// The last third of a column, by way of the cache, is what the whole column has there.
void read_part(const formats::TableReader& reader, std::size_t k, const formats::ChunkEntry& entry,
               const std::vector<std::byte>& whole) {
  const std::size_t stride = reader.schema().channels[k].stride();
  const std::uint32_t count = entry.count / 3;
  std::vector<std::byte> part(count * stride);
  reader.read(k, entry.first + entry.count - count, count, part);
  demand(std::equal(part.rbegin(), part.rend(), whole.rbegin()), "a part is part of the whole");
}

ColumnBytes read_column(const std::string& path, const formats::TableReader& reader, std::size_t k,
                        const formats::ChunkEntry& entry) {
  const formats::Channel& channel = reader.schema().channels[k];
  ColumnBytes column;
  const std::uint64_t size = entry.count * std::uint64_t{channel.stride()};
  column.readable = size > kMostBytes;
  if (column.readable) return column;
  column.bytes.resize(static_cast<std::size_t>(size));
  try {
    reader.read(k, entry.first, entry.count, column.bytes);
    column.readable = true;
  } catch (const Error& error) {
    demand_good_error(error, path);
    column.bytes.clear();
    return column;
  }
  read_part(reader, k, entry, column.bytes);
  if (!has_floats(channel)) return column;
  std::vector<float> values(entry.count * channel.decoded_components());
  reader.read_floats(k, entry.first, entry.count, values);
  return column;
}

// A pass may be without records of a table.
void check_totals(const formats::TableReader& reader, bool of_paths) {
  std::uint64_t in_chunks = 0, in_passes = 0;
  for (const formats::ChunkEntry& entry : reader.chunks()) {
    demand(entry.first == in_chunks && entry.count > 0, "chunks have no gaps");
    in_chunks += entry.count;
  }
  for (const formats::Pass& pass : reader.passes()) {
    demand(pass.first == in_passes && (pass.count > 0 || !of_paths), "passes have no gaps");
    in_passes += pass.count;
  }
  demand(in_chunks == reader.records() && in_passes == reader.records(), "totals add up");
}

}  // namespace

Contents read_everything(const formats::Reader& reader) {
  Contents contents;
  contents.records = reader.records();
  for (std::size_t t = 0; t < reader.head().table_count(); ++t) {
    const formats::TableReader& table = reader.table(t);
    check_totals(table, t == 0);
    for (std::size_t k = 0; k < table.schema().channels.size(); ++k) {
      std::vector<ColumnBytes> columns;
      for (const formats::ChunkEntry& entry : table.chunks()) {
        columns.push_back(read_column(reader.path(), table, k, entry));
        contents.complete = contents.complete && columns.back().readable;
      }
      if (t == 0) contents.columns.push_back(std::move(columns));
    }
  }
  try {
    contents.resume_state = reader.resume_state();
  } catch (const Error& error) {
    demand_good_error(error, reader.path());
    contents.complete = false;
  }
  return contents;
}

void demand_good_error(const Error& error, const std::string& path) {
  const std::string text = error.what();
  demand(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::limit,
         "bad bytes are bad input: " + text);
  demand(text.rfind(path, 0) == 0, "an error names its file: " + text);
  demand(text.find('\n') == std::string::npos, "an error is one line: " + text);
}

}  // namespace psf::fuzz
