// Appends the frames of version 1 to a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/codec.h"
#include "formats/commit.h"
#include "formats/file.h"
#include "formats/frame.h"
#include "formats/slot.h"

namespace psf::formats {

// Every call throws Error{io} where the system does; then the file ends with what is no whole
// frame.
class FrameWriter {
 public:
  // Of a new file, which write_start() begins.
  FrameWriter(File file, const Uuid& uuid) : file_(std::move(file)), uuid_(uuid) {}
  // Goes on behind the frame `last` of a file that begins with the frame `head`.
  FrameWriter(File file, const Frame& head, const Prefix& last);

  // HEAD and an empty SLOT.
  void write_start(const Head& head);
  ChunkEntry write_chunk(std::uint64_t first, std::uint32_t count, std::uint32_t pass,
                         std::span<const EncodedColumn> columns);
  // Fills in the sections of `commit`. Returns what the slot has to say of it.
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
  std::uint64_t sequence_ = 0;         // of the next frame
};

}  // namespace psf::formats
