// A folder of numpy arrays. The layout of .npy: NEP 1, "A Simple File Format for NumPy Arrays".
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

#include "core/interrupt.h"
#include "export/export.h"
#include "export/file.h"
#include "export/output_folder.h"

namespace psf::exports {
namespace {

std::string header(std::string_view type, std::uint64_t count, std::size_t components) {
  const std::string shape =
      components == 1 ? fmt::format("({},)", count) : fmt::format("({}, {})", count, components);
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  constexpr std::size_t kBefore = 10;  // magic, version, length
  text.append(64 - (kBefore + text.size() + 1) % 64, ' ');
  text += '\n';
  std::string all("\x93NUMPY\x01\x00", 8);
  all += static_cast<char>(text.size() & 0xFF);
  all += static_cast<char>(text.size() >> 8);
  return all + text;
}

std::string_view descr(const formats::Channel& channel) {
  if (channel.encoding == formats::Encoding::octahedral) return "<f4";
  switch (channel.type) {
    case formats::Type::u8:
      return "|u1";
    case formats::Type::u16:
      return "<u2";
    case formats::Type::u32:
      return "<u4";
    case formats::Type::u64:
      return "<u8";
    case formats::Type::f16:
      return "<f2";
    case formats::Type::f32:
      return "<f4";
    case formats::Type::f64:
      return "<f8";
  }
  return "";
}

// A channel's name may hold what a file name must not, "/" above all.
std::string file_stem(std::string name, std::set<std::string>& taken) {
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '.' && c != '_' && c != '-'; },
      '_');
  if (name.front() == '.') name.front() = '_';
  std::string unique = name;
  for (int k = 2; !taken.insert(unique).second; ++k) unique = fmt::format("{}_{}", name, k);
  return unique;
}

}  // namespace

ExportResult export_npy(const formats::Reader& reader, const ExportSelection& selection,
                        const std::string& folder, const ExportProgress& progress) {
  const ExportRecords records(reader, selection);
  const std::vector<std::size_t> channels = records.find_or_all(selection.channels);
  ExportResult outcome;
  outcome.records = outcome.written = records.size();
  outcome.passes = records.passes();
  OutputFolder output(folder, "the arrays");
  const std::uint64_t steps = (channels.size() + 1) * records.size();
  std::uint64_t step = 0;
  // read(k, count) gives the bytes of selected records [k, k + count).
  const auto write_array = [&](const std::string& stem, std::string_view type,
                               std::size_t components, std::size_t stride, const auto& read) {
    const std::string name = stem + ".npy";
    outcome.files.push_back(output.shown(name));
    ExportFile file(output.temporary(name), outcome.files.back());
    file.write(header(type, records.size(), components));
    const std::size_t batch = records.batch(stride);
    for (std::uint64_t k = 0; k < records.size(); k += batch) {
      core::throw_if_interrupted("nothing was exported");
      const auto count =
          static_cast<std::size_t>(std::min<std::uint64_t>(batch, records.size() - k));
      file.write(read(k, count));
      step += count;
      if (progress) progress(step, steps);
    }
    file.close();
    outcome.bytes += file.bytes();
  };

  std::set<std::string> taken = {"pass"};
  std::vector<std::byte> stored;
  std::vector<float> floats;
  for (const std::size_t k : channels) {
    const formats::Channel& channel = records.schema().channels[k];
    const bool decode = channel.encoding == formats::Encoding::octahedral;
    const std::size_t components = channel.decoded_components();
    write_array(file_stem(channel.name, taken), descr(channel), components,
                decode ? components * sizeof(float) : channel.stride(),
                [&](std::uint64_t first, std::size_t count) {
                  if (decode) {
                    records.read_floats(k, first, count, floats);
                    return std::as_bytes(std::span(floats));
                  }
                  records.read(k, first, count, stored);
                  return std::as_bytes(std::span(stored));
                });
  }
  std::vector<std::uint32_t> passes;
  write_array("pass", "<u4", 1, sizeof passes[0], [&](std::uint64_t first, std::size_t count) {
    passes.resize(count);
    for (std::size_t i = 0; i < count; ++i) passes[i] = records.pass(first + i);
    return std::as_bytes(std::span(passes));
  });
  outcome.files.push_back(output.shown("metadata.json"));
  ExportFile metadata(output.temporary("metadata.json"), outcome.files.back());
  metadata.write(reader.head().metadata);
  metadata.close();
  outcome.bytes += metadata.bytes();
  output.commit();
  return outcome;
}

}  // namespace psf::exports
