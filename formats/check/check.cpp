#include "formats/check/check.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>

#include "core/error.h"
#include "formats/check/check_frames.h"
#include "formats/layout/chunk.h"
#include "formats/layout/layout.h"

namespace psf::formats {
namespace {

constexpr std::size_t kChunksChecked = 64;  // chunks between two reports of progress

struct NumberedChunk {
  WalkedChunk chunk;
  std::uint64_t number = 0;  // in its table
};

// Columns of one chunk and the padding around them.
void check_columns(const File& file, const Walk& walk, const NumberedChunk& numbered,
                   CheckResult& report) {
  const Head& head = walk.head.head;
  const Schema& schema = head.schema(numbered.chunk.table);
  const ChunkEntry& entry = numbered.chunk.entry;
  const FrameResult result = read_frame(file, walk.file_size, entry.offset, &walk.uuid());
  if (result.state != FrameState::whole) return;  // it changed since: the walk was right then
  const Chunk chunk = decode_chunk(result.frame, head);
  thread_local Buffer buffer;
  std::uint64_t place = kPrefix + result.frame.directory.size();
  for (std::size_t k = 0; k < chunk.columns.size(); ++k) {
    const Column& column = chunk.columns[k];
    check_zeros(file, result.frame.prefix, place, column.offset, report);
    place = column.offset + column.stored;
    ++report.columns;
    try {
      read_column(file, entry.offset, column,
                  buffer.get(chunk.count * schema.channels[k].stride()));
    } catch (const Error& error) {
      if (error.code() == ErrorCode::io) throw;
      report.faults.push_back({entry.offset,
                               type_name(result.frame.prefix.type),
                               {},
                               schema.channels[k].name,
                               entry.first,
                               entry.count,
                               error.what()});
    }
  }
  check_zeros(file, result.frame.prefix, place, result.frame.prefix.length, report);
  for (Fault& fault : report.faults) {
    fault.chunk = numbered.number;
    if (numbered.chunk.table > 0) fault.table = head.table_name(numbered.chunk.table);
  }
}

std::vector<NumberedChunk> in_order(const Walk& walk) {
  std::vector<std::uint64_t> numbers(walk.head.head.table_count());
  std::vector<NumberedChunk> chunks;
  for (const auto& [offset, chunk] : walk.chunks) chunks.push_back({chunk, numbers[chunk.table]++});
  return chunks;
}

void summarise(const Walk& walk, CheckResult& report) {
  const Commit& last = walk.commits.back().commit;
  report.head = walk.head.head;
  report.file_bytes = walk.file_size;
  report.uncommitted_bytes = walk.file_size - walk.end;
  report.frames = walk.frames.size() + 1;
  report.chunks = walk.chunks.size();
  report.commits = walk.commits.size();
  report.records = last.records;
  report.passes = last.passes;
  for (const TableTotals& table : last.tables) report.table_records.push_back(table.records);
  report.closed = (last.flags & kClosed) != 0;
}

}  // namespace

std::string Fault::text() const {
  std::string line = fmt::format("byte {}", offset);
  if (!frame.empty()) line += ": " + frame;
  if (chunk) line += fmt::format(" {}", *chunk);
  if (!table.empty()) line += ": table " + table;
  if (!channel.empty()) line += ": channel " + channel;
  if (records > 0) line += ": " + record_range(first, records);
  return line + ": " + message;
}

CheckResult check(const std::string& path,
                  const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  const File file = File::open(path);
  CheckResult report;
  Walk walk = walk_frames(file, read_head(file, file.size()));
  if (walk.commits.empty()) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: holds no readable commit: its writer was stopped before the "
                            "first, or it is damaged; 'psf recover' saves what is whole",
                            path));
  }
  // What comes behind the last commit is no fault, whatever it is.
  drop_behind(walk, walk.end);
  check_frames(file, walk, report);
  report.faults.insert(report.faults.end(), walk.faults.begin(), walk.faults.end());
  summarise(walk, report);
  const std::vector<NumberedChunk> chunks = in_order(walk);
  for (std::size_t begin = 0; begin < chunks.size(); begin += kChunksChecked) {
    const std::size_t end = std::min(begin + kChunksChecked, chunks.size());
    std::vector<CheckResult> parts(end - begin);
    tbb::parallel_for(begin, end, [&](std::size_t k) {
      if (chunks[k].chunk.readable) check_columns(file, walk, chunks[k], parts[k - begin]);
    });
    for (CheckResult& part : parts) {
      report.columns += part.columns;
      std::move(part.faults.begin(), part.faults.end(), std::back_inserter(report.faults));
    }
    const ChunkEntry& last = chunks[end - 1].chunk.entry;
    if (progress) progress(last.offset + last.length, walk.file_size);
  }
  std::stable_sort(report.faults.begin(), report.faults.end(),
                   [](const Fault& a, const Fault& b) { return a.offset < b.offset; });
  return report;
}

}  // namespace psf::formats
