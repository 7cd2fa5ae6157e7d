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

// A channel of a dump: one or more values a record.
struct Channel {
  std::string name;            // 1 to 56 visible ASCII characters, unique in the dump
  std::string type;            // "u8", "u16", "u32", "u64", "f16", "f32", "f64"
  std::size_t components = 1;  // values a record, 1 to 16
  bool octahedral = false;     // unit vectors in two components, read as three floats
};

// How a dump is filtered, beside the parameters of the filter.
struct FilterOptions {
  Passes passes;                            // the passes that are filtered
  bool layers = true;                       // all layers of psf filter, not the colours alone
  std::optional<std::uint64_t> max_memory;  // bytes; where they do not suffice: Error{limit}
  // As --vertex of the commands: "first-rough", "depth:K", "roughness:T", "distance:D"; empty: the
  // vertex of the file.
  std::string vertex = {};
  // Called now and then by the thread that filters, with numbers of paths.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress = {};
};

// The pictures, and what there was to filter; numbers of records are those of all blocks together.
struct FilterResult {
  std::vector<Picture> pictures;   // one a camera
  std::vector<std::string> notes;  // what was switched off, and why
  std::uint64_t passes = 0;        // passes that were filtered
  std::uint64_t blocks = 0;        // blocks that they fell into
  std::uint64_t sources = 0;       // records that could be averaged
  std::uint64_t queries = 0;       // records that got an average
  std::uint64_t orphans = 0;       // queries without a source in reach, which took the nearest
  std::uint64_t left_out = 0;  // records with values that are not finite, which are in no picture
  double neighbors = 0;        // records averaged, mean over the queries
};

// A path-vertex buffer that is read. A value that moves and owns the open file; a moved-from one
// may only be destroyed or assigned to. `refresh()` aside, several threads may call it at once.
class PSF_API Dump {
 public:
  // Opens a file up to its last commit; it may still be growing. Throws Error{io} where it cannot
  // be opened, Error{bad_input} where it is no path-vertex buffer, is damaged, or has no committed
  // pass.
  explicit Dump(const std::string& path);
  ~Dump();                           // Closes the file.
  Dump(Dump&&) noexcept;             // Takes over the open file.
  Dump& operator=(Dump&&) noexcept;  // Closes the own file and takes over the other.

  [[nodiscard]] const std::string& path() const;  // as it was opened
  [[nodiscard]] std::uint64_t records() const;    // committed when the dump was opened or refreshed
  [[nodiscard]] std::uint64_t passes() const;     // committed likewise
  [[nodiscard]] bool closed() const;              // its producer has finished it
  [[nodiscard]] std::string metadata() const;     // JSON, as in the file
  [[nodiscard]] const std::vector<Channel>& channels() const;  // in the order of the file
  [[nodiscard]] const std::vector<Camera>& cameras() const;    // in the order of the file
  // Takes in what was committed since; returns whether there was anything. Throws Error{usage}
  // where another call is at work on the dump.
  bool refresh();

  // Records [first, first + count) of a channel as stored: `out` has count * components values.
  // Thread-safe. Throws Error{bad_input} for a channel that is not there or a checksum that is
  // wrong.
  void read(std::string_view channel, std::uint64_t first, std::uint64_t count,
            std::span<std::byte> out) const;
  // The same as floats, of channels of floating point and of octahedral ones (3 a record).
  void read_floats(std::string_view channel, std::uint64_t first, std::uint64_t count,
                   std::span<float> out) const;

  // What psf filter does. Throws Error{usage}, Error{bad_input}, Error{limit}, Error{interrupted}.
  [[nodiscard]] FilterResult filter(const Parameters& parameters = {},
                                    const FilterOptions& options = {}) const;
  // What psf sweep does, without files: every set, measured against a reference of one camera by
  // the metrics of these names; empty: relMSE. Sets that differ in r0 and delta alone share the
  // work.
  [[nodiscard]] SweepResult sweep(const Picture& reference, std::span<const Parameters> sets,
                                  std::span<const std::string> metrics = {},
                                  const FilterOptions& options = {}, std::size_t camera = 0) const;
  // What psf tune does: the error of every set without a reference, from independent parts of the
  // passes. Throws as filter() does, and Error{usage} for sets of one block.
  [[nodiscard]] TuneResult tune(std::span<const Parameters> sets,
                                const TuneOptions& options = {}) const;
  // What psf ablate does, without a folder: the weights of `parameters` one after another, blocks
  // against each other, iterations of one pass. Throws as filter() does.
  [[nodiscard]] AblationResult ablate(const Parameters& parameters = {},
                                      const AblateOptions& options = {}) const;
  // What psf explain does: a pixel, 0,0 at the top left, as filter() makes it. Throws as filter()
  // does, and Error{usage} for a pixel that the picture does not have, Error{bad_input} where no
  // path falls into the pixel.
  [[nodiscard]] Explanation explain(std::uint32_t x, std::uint32_t y,
                                    const Parameters& parameters = {},
                                    const ExplainOptions& options = {}) const;
  // The same of one path, by its number in the dump. Throws as filter() does, and Error{usage}
  // where it is not among the passes chosen.
  [[nodiscard]] Explanation explain_path(std::uint64_t path, const Parameters& parameters = {},
                                         const ExplainOptions& options = {}) const;

 private:
  friend class Explanation;
  struct State;
  std::shared_ptr<State> state_;
};

// How a dump is written.
struct WriterOptions {
  bool compress = true;  // zstd
  // More metadata: a JSON object with keys of formats/README.md, "Metadata", or of your own.
  std::string metadata;
};

// Writes a dump. The file appears under its name with its first pass, whole; what is not committed
// is not in it. Calls may come from several threads, one after the other.
class PSF_API DumpWriter {
 public:
  // Starts a file. `cameras`: at least one; they stand for those that the metadata may name, of
  // which those of the same name keep their matrices. Throws Error{io}, Error{bad_input} for
  // channels, cameras or metadata that break the rules of the format.
  DumpWriter(const std::string& path, std::span<const Camera> cameras,
             std::span<const Channel> channels, const WriterOptions& options = {});
  ~DumpWriter();                                 // Leaves what is committed, or no file.
  DumpWriter(DumpWriter&&) noexcept;             // Takes over the file that is written.
  DumpWriter& operator=(DumpWriter&&) noexcept;  // Ends the own file and takes over the other.

  // Appends records to the current pass. columns[k]: (count, components) values of channel k, which
  // are copied. Throws Error{io}, Error{usage}.
  void append(std::size_t count, std::span<const void* const> columns);
  // Ends the pass and writes it to the disk: it survives whatever happens after. Throws Error{io},
  // Error{usage} where the pass has no records.
  void commit_pass();
  // Says that there is nothing to come. Throws Error{usage} where records are not committed.
  void close();

  [[nodiscard]] const std::vector<Channel>& channels() const;  // as given to the constructor
  [[nodiscard]] std::uint64_t records() const;                 // committed
  [[nodiscard]] std::uint64_t passes() const;                  // committed

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace psf
