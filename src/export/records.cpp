#include "export/records.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "core/error.h"

namespace psf::exports {
namespace {

constexpr std::size_t kBatchBytes = std::size_t{64} << 20;
constexpr std::size_t kBatchRecords = std::size_t{1} << 18;

// Keeps every K-th of the values of `width` elements each.
template <class T>
void thin(std::vector<T>& values, std::size_t width, std::size_t count, std::uint64_t every) {
  for (std::size_t k = 1; every > 1 && k < count; ++k) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(k * every * width), width,
                values.begin() + static_cast<std::ptrdiff_t>(k * width));
  }
  values.resize(count * width);
}

const formats::TableReader& table_of(const formats::Reader& reader, const std::string& name) {
  if (const formats::TableReader* found = reader.find_table(name)) return *found;
  std::string all;
  for (std::size_t k = 0; k < reader.head().table_count(); ++k) {
    all += fmt::format("{}{}", k > 0 ? ", " : "", reader.head().table_name(k));
  }
  throw Error(ErrorCode::bad_input,
              fmt::format("{}: has no table {}; it has {}", reader.path(), name, all));
}

}  // namespace

ExportRecords::ExportRecords(const formats::Reader& reader, const ExportSelection& selection)
    : path_(reader.path()), table_(table_of(reader, selection.table)), every_(selection.every) {
  const auto passes = table_.passes();
  const std::size_t begin = selection.passes.first;
  const std::size_t end = selection.passes.last.value_or(passes.size());
  if (begin >= end || end > passes.size()) {
    throw Error(ErrorCode::usage, fmt::format("{}: has passes 0:{}, {}:{} is no part of them",
                                              reader.path(), passes.size(), begin, end));
  }
  first_ = passes[begin].first;
  passes_ = end - begin;
  const std::uint64_t records = passes[end - 1].first + passes[end - 1].count - first_;
  size_ = records / every_ + (records % every_ > 0 ? 1 : 0);
}

std::uint32_t ExportRecords::pass(std::uint64_t k) const {
  const auto passes = table_.passes();
  const auto behind =
      std::upper_bound(passes.begin(), passes.end(), record(k),
                       [](std::uint64_t at, const formats::Pass& pass) { return at < pass.first; });
  return static_cast<std::uint32_t>(behind - passes.begin() - 1);
}

std::vector<std::size_t> ExportRecords::find(std::span<const std::string> names) const {
  std::vector<std::size_t> places;
  for (const std::string& name : names) {
    const auto place = table_.schema().find(name);
    if (!place) {
      std::vector<std::string> all;
      for (const formats::Channel& channel : table_.schema().channels) all.push_back(channel.name);
      throw Error(ErrorCode::bad_input, fmt::format("{}: {}has no channel {}; it has {}", path_,
                                                    table_.prefix(), name, fmt::join(all, ", ")));
    }
    if (std::find(places.begin(), places.end(), *place) == places.end()) places.push_back(*place);
  }
  return places;
}

std::vector<std::size_t> ExportRecords::find_or_all(std::span<const std::string> names) const {
  if (!names.empty()) return find(names);
  std::vector<std::size_t> channels(table_.schema().channels.size());
  std::iota(channels.begin(), channels.end(), std::size_t{0});
  return channels;
}

void ExportRecords::read(std::size_t channel, std::uint64_t k, std::size_t count,
                         std::vector<std::byte>& out) const {
  if (count == 0) return out.clear();
  const std::size_t width = table_.schema().channels[channel].stride();
  const std::size_t whole = static_cast<std::size_t>((count - 1) * every_ + 1);
  out.resize(whole * width);
  table_.read(channel, record(k), whole, out);
  thin(out, width, count, every_);
}

void ExportRecords::read_floats(std::size_t channel, std::uint64_t k, std::size_t count,
                                std::vector<float>& out) const {
  if (count == 0) return out.clear();
  const std::size_t width = table_.schema().channels[channel].decoded_components();
  const std::size_t whole = static_cast<std::size_t>((count - 1) * every_ + 1);
  out.resize(whole * width);
  table_.read_floats(channel, record(k), whole, out);
  thin(out, width, count, every_);
}

std::size_t ExportRecords::batch(std::size_t bytes) const {
  const std::size_t fit = std::min(kBatchRecords, kBatchBytes / std::max<std::size_t>(1, bytes));
  return static_cast<std::size_t>(std::max<std::uint64_t>(1, fit / every_));
}

std::string component_name(const formats::Channel& channel, std::size_t c) {
  const std::size_t count = channel.decoded_components();
  if (count == 1) return channel.name;
  const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
    return count == 3 && std::find(names.begin(), names.end(), channel.name) != names.end();
  };
  if (channel.encoding == formats::Encoding::octahedral ||
      is_one_of({"position", "normal", "direction"})) {
    return fmt::format("{}_{}", channel.name, "xyz"[c]);
  }
  const bool is_layer = count == 3 && (channel.name.starts_with("contribution.") ||
                                       channel.name.starts_with("unfiltered."));
  if (is_layer || is_one_of({"throughput", "contribution", "unfiltered", "reflectance"})) {
    return fmt::format("{}_{}", channel.name, "rgb"[c]);
  }
  return fmt::format("{}_{}", channel.name, c);
}

bool is_float(const formats::Channel& channel) {
  return channel.encoding == formats::Encoding::octahedral || channel.type == formats::Type::f16 ||
         channel.type == formats::Type::f32 || channel.type == formats::Type::f64;
}

}  // namespace psf::exports
