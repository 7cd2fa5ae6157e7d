#include "formats/read/column_cache.h"

#include <algorithm>
#include <utility>

namespace psf::formats {

ColumnCache::Bytes ColumnCache::find(std::uint64_t chunk, std::size_t channel) {
  const std::scoped_lock lock(mutex_);
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.chunk == chunk && entry.channel == channel;
  });
  if (found == entries_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, found);
  return found->bytes;
}

void ColumnCache::insert(std::uint64_t chunk, std::size_t channel, Bytes bytes) {
  const std::scoped_lock lock(mutex_);
  held_ += bytes->size();
  entries_.push_front({chunk, channel, std::move(bytes)});
  while (held_ > most_ && entries_.size() > 1) {
    held_ -= entries_.back().bytes->size();
    entries_.pop_back();
  }
}

}  // namespace psf::formats
