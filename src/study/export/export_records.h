// The records of a dump that an export writes: a range of passes, thinned, read in batches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/reader.h"
#include "study/filter_dump.h"

namespace psf::study {

struct ExportSelection {
  std::vector<std::string> channels;  // by name; empty: what the format has by default
  PassSelection passes;
  std::uint64_t every = 1;  // write every K-th of the records, from the first on
};

class ExportRecords {
 public:
  // Throws Error{usage} for passes that the file does not have. Keeps a reference to the reader.
  ExportRecords(const formats::Reader& reader, const ExportSelection& selection);

  [[nodiscard]] const formats::Reader& reader() const { return reader_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t passes() const { return passes_; }
  // Place in the file of selected record k.
  [[nodiscard]] std::uint64_t record(std::uint64_t k) const { return first_ + k * every_; }
  [[nodiscard]] std::uint32_t pass(std::uint64_t k) const;

  // Channels by name, in the order given; Error{bad_input} that lists those of the file.
  [[nodiscard]] std::vector<std::size_t> find(std::span<const std::string> names) const;
  // The same; without names all channels of the file.
  [[nodiscard]] std::vector<std::size_t> find_or_all(std::span<const std::string> names) const;

  // Selected records [k, k + count) as stored, or as floats (f16, f32, f64, octahedral).
  void read(std::size_t channel, std::uint64_t k, std::size_t count,
            std::vector<std::byte>& out) const;
  void read_floats(std::size_t channel, std::uint64_t k, std::size_t count,
                   std::vector<float>& out) const;

  // How many records to take at a time so that they and what is read to find them are at most
  // 64 MiB; `bytes` of a record, as it is kept in memory.
  [[nodiscard]] std::size_t batch(std::size_t bytes) const;

 private:
  const formats::Reader& reader_;
  std::uint64_t first_ = 0, size_ = 0, passes_ = 0, every_ = 1;
};

// "position_x", "reflectance_r", "distance": component c of the value that a reader gets.
[[nodiscard]] std::string component_name(const formats::Channel& channel, std::size_t c);
// f16, f32, f64, or octahedral, which is read as three floats.
[[nodiscard]] bool is_float(const formats::Channel& channel);

}  // namespace psf::study
