// Path-vertex buffers: reading, filtering and writing them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "psf/error.h"
#include "psf/explain.h"
#include "psf/export.h"
#include "psf/filter.h"
#include "psf/parameters.h"
#include "psf/passes.h"
#include "psf/picture.h"
#include "psf/study.h"

namespace psf {

struct Channel {
  std::string name;
  std::string type;  // "u8", "u16", "u32", "u64", "f16", "f32", "f64"
  std::size_t components = 1;
  bool octahedral = false;  // unit vectors in two components, read as three floats
};

struct FilterOptions {
  Passes passes;
  bool layers = true;                       // all layers of psf filter, not the colours alone
  std::optional<std::uint64_t> max_memory;  // bytes
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress = {};  // paths
};

struct FilterResult {
  std::vector<Picture> pictures;   // one a camera
  std::vector<std::string> notes;  // what was switched off, and why
  std::uint64_t passes = 0, blocks = 0;
  std::uint64_t sources = 0, queries = 0, orphans = 0, left_out = 0;  // records of all blocks
  double neighbors = 0;                                               // mean over the queries
};

class PSF_API Dump {
 public:
  // Throws Error{io} where the file cannot be opened, Error{bad_input} where it is no path-vertex
  // buffer, is damaged, or has no committed pass.
  explicit Dump(const std::string& path);
  ~Dump();
  Dump(Dump&&) noexcept;
  Dump& operator=(Dump&&) noexcept;

  [[nodiscard]] const std::string& path() const;
  [[nodiscard]] std::uint64_t records() const;
  [[nodiscard]] std::uint64_t passes() const;
  [[nodiscard]] bool closed() const;           // its producer has finished it
  [[nodiscard]] std::string metadata() const;  // JSON, as in the file
  [[nodiscard]] const std::vector<Channel>& channels() const;
  [[nodiscard]] const std::vector<Camera>& cameras() const;
  // Takes in what was committed since; returns whether there was anything. Throws Error{usage} where
  // another call is at work on the dump. All other calls may be made from several threads at once.
  bool refresh();

  // Records [first, first + count) of a channel as stored: `out` has count * components values.
  // Thread-safe. Throws Error{bad_input} for a channel that is not there or a checksum that is wrong.
  void read(std::string_view channel, std::uint64_t first, std::uint64_t count,
            std::span<std::byte> out) const;
  // The same as floats, of channels of floating point and of octahedral ones (3 a record).
  void read_floats(std::string_view channel, std::uint64_t first, std::uint64_t count,
                   std::span<float> out) const;

  // What psf filter does. Throws Error{usage}, Error{bad_input}, Error{limit}, Error{interrupted}.
  [[nodiscard]] FilterResult filter(const Parameters& parameters = {},
                                    const FilterOptions& options = {}) const;
  // What psf sweep does, without files: every set, measured against a reference of one camera by
  // the metrics of these names; empty: relMSE. Sets that differ in r0 and delta alone share the work.
  [[nodiscard]] std::vector<SweepRow> sweep(const Picture& reference,
                                            std::span<const Parameters> sets,
                                            std::span<const std::string> metrics = {},
                                            const FilterOptions& options = {},
                                            std::size_t camera = 0) const;
  // What psf tune does: the error of every set without a reference, from independent parts of the
  // passes. Throws as filter() does, and Error{usage} for sets of one block.
  [[nodiscard]] TuneResult tune(std::span<const Parameters> sets,
                                const TuneOptions& options = {}) const;
  // What psf explain does: a pixel, 0,0 at the top left, or one path, by its number in the dump,
  // as filter() makes it. Throws as filter() does, and Error{usage} for a pixel or path that the
  // dump does not have, Error{bad_input} where no path falls into the pixel.
  [[nodiscard]] Explanation explain(std::uint32_t x, std::uint32_t y,
                                    const Parameters& parameters = {},
                                    const ExplainOptions& options = {}) const;
  [[nodiscard]] Explanation explain_path(std::uint64_t path, const Parameters& parameters = {},
                                         const ExplainOptions& options = {}) const;

 private:
  friend class Explanation;
  struct State;
  std::shared_ptr<State> state_;
};

struct WriterOptions {
  bool compress = true;  // zstd
  // More metadata: a JSON object with keys of formats/README.md, "Metadata", or of your own.
  std::string metadata;
};

// Writes a dump; calls may come from several threads, one after the other. The file appears under its name with its first pass, whole; what is not committed
// is not in it.
class PSF_API DumpWriter {
 public:
  // `cameras`: at least one; they stand for those that the metadata may name, of which those of the
  // same name keep their matrices. Throws Error{io}, Error{bad_input} for channels, cameras or
  // metadata that break the rules of the format.
  DumpWriter(const std::string& path, std::span<const Camera> cameras,
             std::span<const Channel> channels, const WriterOptions& options = {});
  ~DumpWriter();
  DumpWriter(DumpWriter&&) noexcept;
  DumpWriter& operator=(DumpWriter&&) noexcept;

  // Appends records to the current pass. columns[k]: (count, components) values of channel k.
  void append(std::size_t count, std::span<const void* const> columns);
  void commit_pass();
  // Says that there is nothing to come. Throws Error{usage} where records are not committed.
  void close();

  [[nodiscard]] const std::vector<Channel>& channels() const;
  [[nodiscard]] std::uint64_t records() const;  // committed
  [[nodiscard]] std::uint64_t passes() const;   // committed

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace psf
