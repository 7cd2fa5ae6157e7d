#include "formats/check/column_reader.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/error.h"
#include "formats/layout/chunk.h"
#include "formats/layout/layout.h"

namespace psf::formats {

std::vector<Fault> ColumnReader::read(const WalkedChunk& walked, std::uint64_t number) {
  const Head& head = walk_.head.head;
  const Schema& schema = head.schema(walked.table);
  const ChunkEntry& entry = walked.entry;
  Fault fault{entry.offset,
              type_name(walked.table == 0 ? kChunkType : kTableChunkType),
              number,
              {},
              entry.first,
              entry.count,
              {}};
  if (walked.table > 0) fault.table = head.table_name(walked.table);
  const FrameResult result = read_frame(file_, walk_.file_size, entry.offset, &walk_.uuid());
  if (result.state != FrameState::whole) {
    fault.message = result.fault;
    return {fault};
  }
  const Chunk chunk = decode_chunk(result.frame, head);
  columns_.resize(schema.channels.size());
  stored_.resize(std::max(stored_.size(), columns_.size()));
  decoded_.resize(stored_.size());
  std::vector<std::string> wrong(columns_.size());
  tbb::parallel_for(std::size_t{0}, columns_.size(), [&](std::size_t k) {
    try {
      columns_[k] = read_stored(file_, entry.offset, chunk.columns[k], stored_[k]);
      if (columns_[k].codec == Codec::raw) return;
      const std::size_t size = chunk.count * schema.channels[k].stride();
      decode_zstd(columns_[k].bytes, columns_[k].filter, decoded_[k].get(size));
    } catch (const Error& error) {
      if (error.code() == ErrorCode::io) throw;
      wrong[k] = error.what();
    }
  });
  std::vector<Fault> faults;
  for (std::size_t k = 0; k < wrong.size(); ++k) {
    if (wrong[k].empty()) continue;
    fault.channel = schema.channels[k].name;
    fault.message = std::move(wrong[k]);
    faults.push_back(fault);
  }
  return faults;
}

}  // namespace psf::formats
