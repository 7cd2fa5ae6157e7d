// Keeps the decoded columns that were used last, so that a reader of small ranges decodes each
// column once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

namespace psf::formats {

class ColumnCache {
 public:
  using Bytes = std::shared_ptr<const std::vector<std::byte>>;

  // `most`: the most bytes to keep; the newest column is always kept. Thread-safe.
  explicit ColumnCache(std::size_t most) : most_(most) {}

  // The column, or null where the cache does not have it.
  [[nodiscard]] Bytes find(std::uint64_t chunk, std::size_t channel);
  void insert(std::uint64_t chunk, std::size_t channel, Bytes bytes);

 private:
  struct Entry {
    std::uint64_t chunk;
    std::size_t channel;
    Bytes bytes;
  };
  std::mutex mutex_;
  std::list<Entry> entries_;  // the one used last comes first
  std::size_t most_, held_ = 0;
};

}  // namespace psf::formats
