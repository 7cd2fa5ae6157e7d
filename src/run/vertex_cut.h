// Makes x_i, alpha_i, c_i and u_i of another vertex of the same paths: formats/README.md, "Tables",
// the table `vertices`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "filter/blocks.h"
#include "formats/read/reader.h"
#include "run/block_records.h"
#include "run/vertex_rule.h"

namespace psf::run {

class VertexCut {
 public:
  // Throws Error{bad_input} where the dump has no vertices, or none with what the rule looks at, of
  // the types that formats/README.md gives.
  // `shade_rate`: of the metadata. The reader must outlive it.
  VertexCut(const formats::Reader& reader, const VertexRule& rule, std::uint32_t shade_rate);

  // Whether the records can have a channel of the paths. `visibility` belongs to the vertex that the
  // renderer selected.
  [[nodiscard]] bool has(std::string_view channel) const;

  // Changes the records of the paths of `range`, which are those of `out`. Where the rule selects
  // what the renderer has selected, a record stays as it is, to the last bit. A path of which it
  // selects nothing has no vertex. Paths are cut in parallel, some thousand vertices at a time,
  // which bounds the memory. Throws Error{bad_input} where a path has no chain of vertices, where
  // chains are not in the order of the paths, and where a record has a vertex but its path has none.
  void apply(const filter::PathRange& range, BlockRecords& out) const;
  // Whether the vertices have a kind and the paths have none, so that apply() makes that channel. The
  // renderer's own choice stays as the paths have it.
  [[nodiscard]] bool makes_kind() const;
  // The most bytes that apply() takes beside the records, and that its reader keeps.
  [[nodiscard]] std::uint64_t memory() const;

 private:
  struct Vertices;  // of some paths
  void cut(std::uint64_t pass, std::uint64_t first, std::uint64_t last, std::size_t place,
           BlockRecords& out) const;
  // The rows of paths [first, last) of a pass, numbers within it: the first, and that behind them.
  struct RowRange {
    std::uint64_t first, last;
  };
  [[nodiscard]] RowRange rows_of(std::uint64_t pass, std::uint64_t first, std::uint64_t last) const;
  [[nodiscard]] std::uint64_t row_of(const formats::Pass& rows, std::uint64_t path) const;
  [[nodiscard]] Vertices read(std::uint64_t first, std::uint64_t last,
                              const BlockRecords& out) const;
  [[nodiscard]] std::size_t select(const Vertices& vertices, std::size_t first,
                                   std::size_t last) const;
  void cut_path(const Vertices& vertices, std::size_t first, std::size_t last, std::size_t i,
                BlockRecords& out) const;
  [[noreturn]] void fail(std::uint64_t row, std::string_view why) const;

  const formats::Reader& reader_;
  const formats::TableReader& table_;
  VertexRule rule_;
  bool all_shaded_;
};

}  // namespace psf::run
