#include "filter/memory.h"

#include <string_view>
#include <type_traits>
#include <utility>

#include "filter/channels.h"
#include "filter/records.h"

namespace psf::filter {
namespace {

constexpr std::uint64_t kVector = 12, kWord = 4, kSum = 24;  // 3 floats, 1 float, 3 doubles
constexpr std::uint64_t kGroup = 16, kQuad = 4;              // records of nodes in engine/tree.h

// Bytes per record of what the terms compare, each channel once.
std::uint64_t compared(const Parameters& parameters) {
  std::uint64_t bytes = 0;
  for_each_channel([&](std::string_view name, const auto& member) {
    using Value = typename std::decay_t<decltype(member(std::declval<Records&>()))>::value_type;
    for (const ChannelNeed& need : optional_channels(parameters)) {
      if (!need.term || need.channel != name) continue;
      bytes += sizeof(Value);
      return;
    }
  });
  return bytes;
}

// Bytes per record of a tree over the sources.
std::uint64_t tree_bytes(std::uint64_t columns) {
  constexpr std::uint64_t kQuads = (2 * kVector + kSum) / kQuad;
  constexpr std::uint64_t kParents = 2;  // per 256 records: node, point of the index, statistics
  const std::uint64_t groups = (2 * columns + kSum + kGroup - 1) / kGroup;
  return columns + kSum + kQuads + groups + kParents;
}

}  // namespace

std::uint64_t memory_per_record(const Parameters& parameters) {
  constexpr std::uint64_t kResult = kVector + kWord + 1;  // c_bar, neighbours, role
  constexpr std::uint64_t kLists = 4 * kWord;  // queries and sources, ascending and in order
  constexpr std::uint64_t kRadius = kWord;

  const EstimatorInfo& estimator = info(parameters.estimator);
  std::uint64_t bytes = kResult + kLists + kRadius + estimator.bytes;
  if (parameters.demodulate || parameters.iterations > 1) bytes += kVector;  // values to average
  if (parameters.fit == BallFit::linear) bytes += kVector + 2 * kWord;       // normals, luminances
  if (!parameters.fireflies.keeps()) {
    bytes += 2 * kVector + kWord;  // values without what is apart, that, and how bright it is
  }
  if (parameters.fireflies.spreads()) {
    constexpr std::uint64_t kPlaces = 5 * kWord, kEnds = 16;
    constexpr std::uint64_t kGifts =
        12 * kWord;  // both ends of 6 a query, more than any scene has had
    // The tree over the queries has no sums, nor has the other one then.
    constexpr std::uint64_t kSumsOfBoth = 2 * (kSum + kSum / kQuad);
    bytes += kPlaces + kEnds + kGifts + tree_bytes(kVector + compared(parameters)) - kSumsOfBoth;
  }
  if (!estimator.has_tree) return bytes;
  return bytes + tree_bytes(kVector + compared(parameters));  // with positions
}

std::uint64_t memory_per_photon(const Parameters& parameters) {
  // Of the set that they are in: three vectors, power, area, material, role; two lists of sources.
  constexpr std::uint64_t kOfSet = 4 * kVector + 2 * kWord + 1 + 2 * kWord;
  return kOfSet + tree_bytes(2 * kVector + compared(parameters));  // with directions
}

std::uint64_t memory_per_record_of_kinds(std::uint64_t layers) {
  return (1 + layers) * kVector + 2 * kWord + 1;  // c_bar, neighbours, radius, role
}

std::uint64_t memory_per_record_of_window(const Parameters& parameters, std::uint64_t layers) {
  constexpr std::uint64_t kMoments = 24, kWeights = 4 + kWord;  // of [relit]; added, material
  const std::uint64_t averages = 1 + layers;
  const std::uint64_t kept = kMoments + kWord + averages * (kVector + kSum);  // and results
  // Of both frames: columns, radius, role, lists, and values with their moments.
  const std::uint64_t columns = kVector + compared(parameters) + kWeights + 1;
  const std::uint64_t both = 2 * (columns + kWord + 1 + 4 * kWord + (2 + averages) * kVector);
  const std::uint64_t means = (1 + averages) * kVector + 2 * kWord;
  return kept + both + means + (1 + averages) * kSum * 2;
}

std::uint64_t memory_per_layer(const Parameters& parameters) {
  // The average, what is averaged in place of the contribution, and what is given.
  const bool apart = !parameters.fireflies.keeps();
  const std::uint64_t values = (apart ? 3u : 2u) * kVector;
  // Of engine/tree_sums.h: a source's, and its shares of its quad's, its group's and its parent's.
  constexpr std::uint64_t kSums = kSum + kSum / kQuad + (kSum + kGroup - 1) / kGroup + 1;
  return values + (info(parameters.estimator).has_tree ? kSums : kVector);
}

}  // namespace psf::filter
