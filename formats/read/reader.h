// Reads a path-vertex buffer up to its last commit: any range of records of any channel of the
// paths, and of its tables, from any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/layout/entries.h"
#include "formats/layout/head.h"
#include "formats/read/table_reader.h"

namespace psf::formats {

class Reader {
 public:
  // Throws Error{io} where the file cannot be opened, Error{bad_input} where it is no readable
  // path-vertex buffer, was written by a later version, or is damaged before its last commit.
  explicit Reader(const std::string& path);
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  [[nodiscard]] const std::string& path() const;
  [[nodiscard]] const Head& head() const;
  [[nodiscard]] bool closed() const;  // the producer has closed the file
  [[nodiscard]] std::uint64_t uncommitted_bytes()
      const;                               // bytes after the last commit; normal after a kill
  [[nodiscard]] std::string uuid() const;  // the file's uuid as text

  // Takes in what was committed since the file was opened or last refreshed; returns whether there
  // was anything. Must not be called while other threads use the reader. Throws what the
  // constructor throws, and Error{bad_input} where another file now has the name.
  bool refresh();
  // Whether a program has the file open to write it.
  [[nodiscard]] bool is_being_written() const;

  [[nodiscard]] std::uint64_t file_bytes() const;
  // The resume state that the producer gave to its last commit.
  [[nodiscard]] std::vector<std::byte> resume_state() const;

  // The records of a table as Head::schema() counts; 0: the paths. They live as long as the reader.
  [[nodiscard]] const TableReader& table(std::size_t number) const;
  // Null where there is no table of this name; `paths` is one.
  [[nodiscard]] const TableReader* find_table(std::string_view name) const;

  // Those of the paths, as TableReader has them.
  [[nodiscard]] std::uint64_t records() const { return table(0).records(); }
  [[nodiscard]] std::span<const Pass> passes() const { return table(0).passes(); }
  [[nodiscard]] std::span<const ChunkEntry> chunks() const { return table(0).chunks(); }
  [[nodiscard]] std::vector<Column> columns(std::size_t chunk) const {
    return table(0).columns(chunk);
  }
  [[nodiscard]] std::size_t require(std::string_view channel, std::string_view wanted_by) const {
    return table(0).require(channel, wanted_by);
  }
  void read(std::size_t channel, std::uint64_t first, std::size_t count,
            std::span<std::byte> out) const {
    table(0).read(channel, first, count, out);
  }
  void read_floats(std::size_t channel, std::uint64_t first, std::size_t count,
                   std::span<float> out) const {
    table(0).read_floats(channel, first, count, out);
  }

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace psf::formats
