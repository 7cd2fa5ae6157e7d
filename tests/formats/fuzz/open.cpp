// Fuzzes opening, reading and checking.
#include <optional>

#include "core/error.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "memory_file.h"
#include "read_everything.h"
#include "targets.h"

namespace psf::fuzz {
namespace {

std::optional<Contents> open_and_read(const std::string& path) {
  try {
    return read_everything(formats::Reader(path));
  } catch (const Error& error) {
    demand_good_error(error, path);
    return std::nullopt;
  }
}

bool has_no_fault(const std::string& path) {
  try {
    const formats::CheckResult report = formats::check(path);
    for (const formats::Fault& fault : report.faults) {
      demand(fault.text().find('\n') == std::string::npos, "a fault is one line");
    }
    return report.faults.empty();
  } catch (const Error& error) {
    demand_good_error(error, path);
    return false;
  }
}

}  // namespace

void fuzz_open(Bytes bytes) {
  static MemoryFile file;
  file.set(bytes);
  const std::optional<Contents> contents = open_and_read(file.path());
  if (!has_no_fault(file.path())) return;
  demand(contents.has_value(), "a file without fault can be opened");
  demand(contents->complete, "a file without fault can be read");
}

}  // namespace psf::fuzz
