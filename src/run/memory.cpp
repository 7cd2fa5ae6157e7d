#include "run/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "filter/channels.h"
#include "filter/memory.h"
#include "filter/parameters/values.h"

namespace psf::run {
namespace {

using filter::BlockSize;

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
constexpr std::uint64_t kProgram =
    48 * kMiB;  // libraries, once relocated, and what the allocator keeps
// Holes that the allocator keeps between the arrays of one block and those of the next.
constexpr std::uint64_t kHolesShare = 5,
                        kMostHoles = 32 * kMiB;  // 1/5 of the filter, at most 32 MiB
constexpr std::uint64_t kThread = 4 * kMiB;      // stack, arena, scratch of the filter
// What the reader keeps of chunks that blocks cut.
constexpr std::uint64_t kReaderCache = 32 * kMiB;

constexpr std::streamsize kLongestLine = 1 << 20;  // longest line of a file in /proc

// The bytes per record in memory for the channels that are read, and those that are made where a
// file has none: flags, and with a choice of the vertex u and kind.
std::uint64_t record_bytes(const Dump& dump, const ChannelSet& set) {
  std::uint64_t bytes = 0;
  filter::for_each_channel([&](std::string_view name, const auto& member) {
    using Value =
        typename std::decay_t<decltype(member(std::declval<BlockRecords&>()))>::value_type;
    const bool made = name == "flags" || (name == "unfiltered" && dump.vertex_rule()) ||
                      (name == "kind" && dump.makes_kind());
    if (member(set) || made) bytes += sizeof(Value);
  });
  for (const LightLayer& layer : set.layers) {
    bytes += sizeof(Rgb) * (layer.contribution ? 1 : 0) + sizeof(Rgb) * (layer.unfiltered ? 1 : 0);
  }
  return bytes;
}

std::uint64_t longest_block(const BlockSize& size, const Dump& dump, std::size_t first,
                            std::size_t last) {
  const filter::Blocks blocks(size, dump.pass_bounds(), first, last);
  // Blocks of b^m are cut at both ends alone; there are no more blocks of passes than passes.
  const bool power = size.kind == BlockSize::Kind::power;
  const std::uint64_t looked_at =
      power ? std::min<std::uint64_t>(2, blocks.count()) : blocks.count();
  std::uint64_t longest = blocks.count() == 0 ? 0 : blocks[blocks.count() - 1].size();
  for (std::uint64_t k = 0; k < looked_at; ++k) longest = std::max(longest, blocks[k].size());
  return longest;
}

// At most so many photons go with a block.
std::uint64_t most_photons(const BlockSize& size, const Dump& dump, std::size_t first,
                           std::size_t last) {
  const filter::Blocks blocks(size, dump.pass_bounds(), first, last);
  std::uint64_t most = 0;
  if (size.kind != BlockSize::Kind::power) {
    for (std::uint64_t k = 0; k < blocks.count(); ++k) {
      most = std::max(most, count_photons(dump.reader(), blocks[k]));
    }
    return most;
  }
  // A block of b^m may begin in the last path of a pass.
  std::uint64_t shortest = blocks.all().size(), longest = longest_block(size, dump, first, last);
  for (std::size_t pass = first; pass < last; ++pass) {
    const filter::PathRange paths{dump.pass_bounds()[pass], dump.pass_bounds()[pass + 1]};
    shortest = std::min(shortest, paths.size());
    most = std::max(most, count_photons(dump.reader(), paths));
  }
  const std::uint64_t passes =
      shortest == 0 ? last - first : (longest + shortest - 2) / shortest + 1;
  return most * std::min<std::uint64_t>(last - first, passes);
}

// A column as stored and one that is not yet in order, for each thread; chunks and passes; what
// blocks that do not end where chunks do keep of them.
std::uint64_t reader_bytes(const Dump& dump, const BlockSize& size) {
  const formats::Reader& reader = dump.reader();
  std::uint64_t chunk = 0, widest = 0;
  for (const formats::ChunkEntry& entry : reader.chunks()) {
    chunk = std::max<std::uint64_t>(chunk, entry.count);
  }
  for (const formats::Channel& channel : reader.head().channels) {
    widest = std::max<std::uint64_t>(widest, channel.stride());
  }
  constexpr std::uint64_t kPass = sizeof(formats::Pass) + 2 * sizeof(std::uint64_t);
  const std::uint64_t index =
      2 * reader.chunks().size() * sizeof(formats::ChunkEntry) + dump.pass_bounds().size() * kPass;
  const std::uint64_t threads = core::thread_count();
  std::uint64_t bytes = index + 2 * threads * chunk * widest;
  if (size.kind == BlockSize::Kind::power) {
    bytes += std::min(kReaderCache, dump.reader().records() * reader.head().stride()) +
             threads * chunk * widest;
  }
  return bytes;
}

class Planner {
 public:
  Planner(const Dump& dump, const ChannelSet& channels, const MemoryRequest& request)
      : dump_(dump),
        r_(request),
        record_bytes_(record_bytes(dump, channels)),
        has_kinds_(channels.kind.has_value() || dump.makes_kind()),
        photon_bytes_(channels.photons ? photon_bytes(*channels.photons) : 0) {
    for (const LightLayer& layer : channels.layers) {
      if (layer.contribution) ++averaged_layers_;
    }
  }

  [[nodiscard]] MemoryEstimate estimate(const BlockSize& size, std::uint64_t blocks) const {
    const std::uint64_t longest = longest_block(size, dump_, r_.first_pass, r_.last_pass);
    MemoryEstimate result;
    result.program = kProgram + kThread * core::thread_count() + reader_bytes(dump_, size) +
                     dump_.vertex_memory();
    result.pictures = dump_.pixels() * r_.bytes_a_pixel;
    result.block = longest * record_bytes_;
    result.blocks = blocks;
    result.filter =
        longest * (filter::memory_per_record(r_.parameters) +
                   averaged_layers_ * filter::memory_per_layer(r_.parameters) +
                   (has_kinds_ ? filter::memory_per_record_of_kinds(averaged_layers_) : 0) +
                   r_.beside_a_record) +
        r_.beside;
    if (r_.window) {
      result.filter += longest * (record_bytes_ + filter::memory_per_record_of_window(
                                                      r_.parameters, averaged_layers_));
    }
    if (photon_bytes_ > 0) {
      const std::uint64_t photons = most_photons(size, dump_, r_.first_pass, r_.last_pass);
      result.block += photons * photon_bytes_;
      result.filter += photons * filter::memory_per_photon(r_.parameters);
    }
    result.program += std::min(result.filter / kHolesShare, kMostHoles);
    result.stored = longest * dump_.reader().head().stride();
    return result;
  }
  [[nodiscard]] bool fits(const MemoryEstimate& estimate) const {
    return !r_.limit || estimate.total() <= *r_.limit;
  }
  [[nodiscard]] bool has_several_blocks() const {
    const filter::Blocks blocks(r_.parameters.block, dump_.pass_bounds(), r_.first_pass,
                                r_.last_pass);
    return blocks.count() > 1;
  }

  // The largest smaller block that fits, in the unit of the one asked for where there is one.
  [[nodiscard]] std::optional<BlockSize> block_that_fits() const {
    BlockSize size = r_.parameters.block;
    if (size.kind != BlockSize::Kind::power) {
      std::uint64_t few = 0, many = r_.last_pass - r_.first_pass;  // fits; does not
      if (size.kind == BlockSize::Kind::passes) many = std::min(many, size.passes);
      size.kind = BlockSize::Kind::passes;
      while (many - few > 1) {
        size.passes = few + (many - few) / 2;
        (fits(estimate(size, 1)) ? few : many) = size.passes;
      }
      size.passes = few;
      if (few > 0) return size;
      size = {BlockSize::Kind::power, 2, kLargestPower, 1};
    }
    size.exponent = std::min(size.exponent, kLargestPower);
    while (size.exponent > 0) {
      --size.exponent;
      if (fits(estimate(size, 1))) return size;
    }
    return std::nullopt;
  }

  [[noreturn]] void refuse() const {
    const BlockSize& asked = r_.parameters.block;
    const std::string needed = fmt::format(
        "{}: `block {}` takes up to {}, and `max-memory` allows {}", dump_.reader().path(),
        filter::to_text(asked), in_mebibytes(estimate(asked, 1).total()), in_mebibytes(*r_.limit));
    const auto size = block_that_fits();
    if (size) {
      throw Error(ErrorCode::limit,
                  fmt::format("{}; `block {}` would fit, with {}", needed, filter::to_text(*size),
                              in_mebibytes(estimate(*size, 1).total())));
    }
    const BlockSize smallest{BlockSize::Kind::power, 2, 0, 1};
    throw Error(ErrorCode::limit, fmt::format("{}; no block would fit, {} are the least", needed,
                                              in_mebibytes(estimate(smallest, 1).total())));
  }

 private:
  static std::string in_mebibytes(std::uint64_t bytes) {
    return fmt::format("{} MiB", (bytes + kMiB - 1) / kMiB);
  }
  static constexpr std::uint32_t kLargestPower = 63;

  const Dump& dump_;
  const MemoryRequest& r_;
  std::uint64_t record_bytes_;
  bool has_kinds_;
  std::uint64_t photon_bytes_, averaged_layers_ = 0;
};

}  // namespace

MemoryEstimate plan_memory(const Dump& dump, const ChannelSet& channels,
                           const MemoryRequest& request) {
  const Planner planner(dump, channels, request);
  const BlockSize& size = request.parameters.block;
  if (core::thread_count() > 1 && planner.has_several_blocks()) {
    const MemoryEstimate ahead = planner.estimate(size, 2);
    if (planner.fits(ahead)) return ahead;
  }
  const MemoryEstimate alone = planner.estimate(size, 1);
  if (!planner.fits(alone)) planner.refuse();
  return alone;
}

bool fits_memory(const Dump& dump, const ChannelSet& channels, const MemoryRequest& request) {
  const Planner planner(dump, channels, request);
  return planner.fits(planner.estimate(request.parameters.block, 1));
}

PeakMemory peak_memory() {
  std::ifstream status("/proc/self/status");
  std::uint64_t peak = 0, of_files = 0, kibibytes = 0;
  for (std::string name; status >> name; status.ignore(kLongestLine, '\n')) {
    if (name == "VmHWM:" && status >> kibibytes) peak = kibibytes * 1024;
    const bool file = name == "RssFile:" || name == "RssShmem:";
    if (file && status >> kibibytes) of_files += kibibytes * 1024;
  }
  return {peak, peak - std::min(peak, of_files)};
}

}  // namespace psf::run
