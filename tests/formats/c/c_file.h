// Files written and read through the C header, and the golden records for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "file_bytes.h"
#include "formats/layout/head.h"
#include "formats/pvb.h"

namespace psf::test {

// A pvb_file that is freed at the end.
class CFile {
 public:
  explicit CFile(pvb_file* file) : file_(file) {}
  ~CFile() { pvb_free(file_); }
  CFile(const CFile&) = delete;
  CFile& operator=(const CFile&) = delete;

  [[nodiscard]] pvb_file* get() const { return file_; }
  [[nodiscard]] const pvb_info& info() const { return *pvb_about(file_); }
  [[nodiscard]] std::string error() const {  // empty: none
    const char* text = pvb_error(file_);
    return text == nullptr ? "" : text;
  }

 private:
  pvb_file* file_;
};

// The channels of a head; their names live in it.
[[nodiscard]] std::vector<pvb_channel> c_channels(const formats::Head& head);

// The golden head, chunks of 16 records, the golden uuid, not synced unless told.
[[nodiscard]] pvb_file* create_golden(const std::string& path, bool sync = false);
[[nodiscard]] pvb_file* resume_golden(const std::string& path, bool sync = false);
int append_golden(pvb_file* file, std::size_t first, std::size_t count);
// A golden pass and its resume state "resume N".
int write_golden_pass(pvb_file* file, std::size_t pass);

// Records of a channel, as the C header reads them; empty and an error where it cannot.
[[nodiscard]] Bytes c_read(pvb_file* file, std::size_t channel, std::uint64_t first,
                           std::size_t count);

// Both readers agree that the file holds `records` golden records and nothing else, and check()
// finds no fault. Empty, or what is wrong.
[[nodiscard]] std::string golden_faults(const std::string& path, std::uint64_t records,
                                        bool only_slot_faults = false);

}  // namespace psf::test
