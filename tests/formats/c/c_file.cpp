#include "c_file.h"

#include "core/error.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "golden.h"

namespace psf::test {
namespace {

const formats::Head& head() {
  static const formats::Head golden = golden_head();
  return golden;
}

}  // namespace

std::vector<pvb_channel> c_channels(const formats::Head& of) {
  std::vector<pvb_channel> out;
  for (const formats::Channel& channel : of.channels) {
    out.push_back({channel.name.c_str(), static_cast<int>(channel.type), channel.components,
                   static_cast<int>(channel.encoding)});
  }
  return out;
}

pvb_file* create_golden(const std::string& path, bool sync) {
  const formats::Uuid uuid = golden_uuid();
  const pvb_options options = {kGoldenCapacity, sync ? 0 : 1, uuid.data()};
  const auto channels = c_channels(head());
  return pvb_create(path.c_str(), channels.data(), channels.size(), head().metadata.c_str(),
                    &options);
}

pvb_file* resume_golden(const std::string& path, bool sync) {
  const pvb_options options = {0, sync ? 0 : 1, nullptr};
  const auto channels = c_channels(head());
  return pvb_resume(path.c_str(), channels.data(), channels.size(), head().metadata.c_str(),
                    &options);
}

int append_golden(pvb_file* file, std::size_t first, std::size_t count) {
  std::vector<Bytes> columns;
  std::vector<pvb_array> arrays;
  for (std::size_t k = 0; k < head().channels.size(); ++k) {
    columns.push_back(golden_values(k, first, count));
    arrays.push_back({columns.back().data(), head().channels[k].stride()});
  }
  return pvb_append(file, count, arrays.data());
}

int write_golden_pass(pvb_file* file, std::size_t pass) {
  append_golden(file, pass * kGoldenPass, kGoldenPass);
  const std::string state = "resume " + std::to_string(pass);
  return pvb_commit(file, state.data(), state.size());
}

Bytes c_read(pvb_file* file, std::size_t channel, std::uint64_t first, std::size_t count) {
  const std::size_t stride = head().channels.at(channel).stride();
  Bytes out(count * stride);
  if (pvb_read(file, channel, first, count, out.data(), stride) != 0) out.clear();
  return out;
}

std::string golden_faults(const std::string& path, std::uint64_t records, bool only_slot_faults) {
  try {
    for (const formats::Fault& fault : formats::check(path).faults) {
      if (!only_slot_faults || fault.frame != "SLOT") return fault.text();
    }
    const formats::Reader reader(path);
    const CFile file(pvb_open(path.c_str()));
    if (!file.error().empty()) return file.error();
    if (reader.records() != records) return "C++: " + std::to_string(reader.records());
    if (file.info().records != records) return "C: " + std::to_string(file.info().records);
    for (std::size_t k = 0; k < head().channels.size(); ++k) {
      const Bytes expected = golden_values(k, 0, records);
      if (read_all(reader, k) != expected) return "C++: values of " + head().channels[k].name;
      if (c_read(file.get(), k, 0, records) != expected) return "C: " + head().channels[k].name;
    }
    return file.error();
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace psf::test
