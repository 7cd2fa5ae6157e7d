// The records of a dump, or of a table of it, that an export writes: every K-th of a range of
// passes, read in batches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/read/reader.h"
#include "run/filter_dump.h"

namespace psf::exports {

struct ExportSelection {
  std::string table = std::string(formats::kPaths);
  std::vector<std::string> channels;  // names; empty: the default of the export's format
  run::PassSelection passes;
  std::uint64_t every = 1;  // write every K-th of the records, from the first on
};

class ExportRecords {
 public:
  // Throws Error{usage} for passes, Error{bad_input} for a table that the file does not have. Keeps
  // a reference to the reader.
  ExportRecords(const formats::Reader& reader, const ExportSelection& selection);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const formats::TableReader& table() const { return table_; }
  [[nodiscard]] const formats::Schema& schema() const { return table_.schema(); }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t passes() const { return passes_; }
  // The place in the file of selected record k.
  [[nodiscard]] std::uint64_t record(std::uint64_t k) const { return first_ + k * every_; }
  [[nodiscard]] std::uint32_t pass(std::uint64_t k) const;

  // The channels with these names, in the order given. Throws Error{bad_input} that lists the
  // file's channels where one is missing.
  [[nodiscard]] std::vector<std::size_t> find(std::span<const std::string> names) const;
  // The channels with these names, or all channels of the file where there are no names.
  [[nodiscard]] std::vector<std::size_t> find_or_all(std::span<const std::string> names) const;

  // Reads a channel of the selected records [k, k + count), as stored, or as floats (f16, f32, f64
  // and octahedral).
  void read(std::size_t channel, std::uint64_t k, std::size_t count,
            std::vector<std::byte>& out) const;
  void read_floats(std::size_t channel, std::uint64_t k, std::size_t count,
                   std::vector<float>& out) const;

  // The number of records to take at a time, so that these records and the bytes read for them are
  // at most 64 MiB. `bytes`: the size of a record in memory.
  [[nodiscard]] std::size_t batch(std::size_t bytes) const;

 private:
  const std::string& path_;
  const formats::TableReader& table_;
  std::uint64_t first_ = 0, size_ = 0, passes_ = 0, every_ = 1;
};

// The name of component c of a channel, as read: "position_x", "reflectance_r", "distance".
[[nodiscard]] std::string component_name(const formats::Channel& channel, std::size_t c);
// Whether a channel is f16, f32, f64, or octahedral, which is read as three floats.
[[nodiscard]] bool is_float(const formats::Channel& channel);

}  // namespace psf::exports
