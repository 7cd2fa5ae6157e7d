// The sources that a packet of queries averages, listed by one walk so that any number of values of
// each can be added up afterwards.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/buffer.h"
#include "filter/engine/tree.h"

namespace psf::filter::engine {

class Found {
 public:
  // Nodes of a family, a bit each: every source below them, `count` in all, for every query.
  struct Nodes {
    LevelName level;
    std::size_t family;
    std::uint32_t bits;
    std::size_t count;
  };
  // A source, by its place in the tree's order, for the queries of a vector of lanes, a bit each.
  struct Source {
    std::uint32_t place, lanes;
  };
  // The sources of the queries in one vector of lanes, in the order in which they were found.
  class List {
   public:
    [[nodiscard]] const Source* begin() const { return sources_.begin(); }
    [[nodiscard]] const Source* end() const { return sources_.begin() + count_; }
    void clear() { count_ = 0; }
    // Where to write up to `most` more; grow_by() says how many there were.
    [[nodiscard]] Source* room_for(std::size_t most) {
      if (sources_.size() < count_ + most) enlarge(count_ + most);
      return sources_.begin() + count_;
    }
    void grow_by(std::size_t count) { count_ += count; }

   private:
    void enlarge(std::size_t least) {
      core::Buffer<Source> larger(std::max(least, 2 * sources_.size()));
      std::copy(begin(), end(), larger.begin());
      sources_ = std::move(larger);
    }
    core::Buffer<Source> sources_;
    std::size_t count_ = 0;
  };

  void clear() {
    nodes.clear();
    for (List& list : sources) list.clear();
  }

  std::vector<Nodes> nodes;
  std::array<List, kWidth> sources;  // by vector of lanes, of which there are kWidth / kLanes
};

}  // namespace psf::filter::engine
