// Fuzzes recovery.
#include "formats/check/recover.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/error.h"
#include "formats/read/reader.h"
#include "memory_file.h"
#include "read_everything.h"
#include "targets.h"

namespace psf::fuzz {
namespace {

// Recovery renames what it wrote, so it needs a folder; one in memory where there is one.
class OutputFolder {
 public:
  OutputFolder() {
    const std::filesystem::path memory = "/dev/shm";
    folder_ =
        (std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path()) /
        ("psf-fuzz-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~OutputFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  [[nodiscard]] std::string file() const { return (folder_ / "out.pvb").string(); }
  [[nodiscard]] bool is_empty() const { return std::filesystem::is_empty(folder_); }

 private:
  std::filesystem::path folder_;
};

std::optional<formats::RecoverResult> recover(const std::string& in, const std::string& out,
                                              bool uncommitted) {
  try {
    return formats::recover(in, out, {uncommitted});
  } catch (const Error& error) {
    demand_good_error(error, in);
    return std::nullopt;
  }
}

std::vector<std::byte> joined(const std::vector<ColumnBytes>& columns) {
  std::vector<std::byte> all;
  for (const ColumnBytes& c : columns) all.insert(all.end(), c.bytes.begin(), c.bytes.end());
  return all;
}

// What lost nothing has every value that the input has, and those of other commits, if the last one
// forgets some.
void compare(const Contents& in, const Contents& out) {
  demand(in.records <= out.records, "no fewer records than the input");
  for (std::size_t k = 0; k < in.columns.size(); ++k) {
    const std::vector<std::byte> before = joined(in.columns[k]), after = joined(out.columns[k]);
    demand(before.size() <= after.size() && std::equal(before.begin(), before.end(), after.begin()),
           "the values of the input");
  }
  demand(in.records < out.records || in.resume_state == out.resume_state,
         "the resume state of the input");
}

std::size_t chunks_of(const formats::Reader& reader) {
  std::size_t chunks = 0;
  for (std::size_t t = 0; t < reader.head().table_count(); ++t) {
    chunks += reader.table(t).chunks().size();
  }
  return chunks;
}

void check_output(const std::string& in, const std::string& out,
                  const formats::RecoverResult& report) {
  demand(formats::check(out).faults.empty(), "the output has no fault");
  const formats::Reader reader(out);
  demand(reader.closed(), "the output is closed");
  demand(reader.records() == report.records_saved && chunks_of(reader) == report.chunks_saved &&
             reader.passes().size() == report.passes_saved,
         "the report has the totals of the output");
  const Contents saved = read_everything(reader);
  demand(saved.complete, "every value of the output can be read");
  if (!report.nothing_lost()) return;
  try {
    const Contents whole = read_everything(formats::Reader(in));
    if (whole.complete) compare(whole, saved);
  } catch (const Error& error) {
    demand_good_error(error, in);  // only recovery can read it
  }
}

}  // namespace

void fuzz_recover(Bytes bytes) {
  static MemoryFile file;
  static const OutputFolder folder;
  file.set(bytes);
  const std::string out = folder.file();
  if (const auto report = recover(file.path(), out, false)) {
    check_output(file.path(), out, *report);
    std::filesystem::remove(out);
  }
  demand(folder.is_empty(), "nothing half-written stays behind");
  if (const auto more = recover(file.path(), out, true)) {
    demand(formats::check(out).faults.empty(),
           "the output with what was not committed has no fault");
    demand(formats::Reader(out).records() == more->records_saved, "as many records as it says");
    std::filesystem::remove(out);
  }
}

}  // namespace psf::fuzz
