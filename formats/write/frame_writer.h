// Appends the frames of version 1 to a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/layout/chunk.h"
#include "formats/layout/codec.h"
#include "formats/layout/commit.h"
#include "formats/layout/file.h"
#include "formats/layout/frame.h"
#include "formats/layout/slot.h"

namespace psf::formats {

// The bytes of records, all channels, that are encoded at a time: this bounds the memory, and there
// is work for all threads.
inline constexpr std::size_t kBatchBytes = std::size_t{64} << 20;

// Every call throws Error{io} where writing fails; the file may then end with an incomplete frame.
class FrameWriter {
 public:
  // For a new file, which write_start() begins.
  FrameWriter(File file, const Uuid& uuid) : file_(std::move(file)), uuid_(uuid) {}
  // For an existing file that begins with the frame `head`; writing goes on behind the frame
  // `last`.
  FrameWriter(File file, const Frame& head, const Prefix& last);

  // Writes HEAD and an empty SLOT.
  void write_start(const Head& head);
  // The places of `chunk`'s columns follow from `columns`.
  ChunkEntry write_chunk(Chunk chunk, std::span<const EncodedColumn> columns);
  // Sets the sections of `commit` and writes it. Returns its record for write_slot().
  SlotRecord write_commit(Commit commit, std::span<const ChunkEntry> index,
                          std::span<const std::byte> resume_state);
  void write_slot(std::uint64_t commit_number, const SlotRecord& record);

  [[nodiscard]] File& file() { return file_; }
  [[nodiscard]] std::uint64_t end() const { return end_; }

 private:
  using Parts = std::vector<std::span<const std::byte>>;
  [[nodiscard]] std::vector<std::byte> front(std::uint32_t type, std::uint32_t flags,
                                             std::span<const std::byte> directory,
                                             std::uint64_t length) const;
  void write(const Parts& parts);

  File file_;
  Uuid uuid_;
  std::vector<std::byte> head_front_;  // prefix and directory of HEAD
  std::uint64_t slot_ = 0, end_ = 0;   // offsets
  std::uint64_t sequence_ = 0;         // sequence number of the next frame
};

}  // namespace psf::formats
