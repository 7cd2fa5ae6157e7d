// The three samplers behind one value type.
#include "render/sample/sampler.h"

#include "render/sample/halton.h"
#include "render/sample/sampler_hash.h"
#include "render/sample/sobol.h"

namespace psf::render {
namespace {

// Points past the dimensions of a sequence, and all of a pixel's: a (0, 2)-net of its own for every
// dimension or pair, whose order is shuffled so that it is independent of the others. Shuffling by
// Owen scrambling of the index keeps aligned blocks of 2^m indices together (B. Burley 2020).
struct Padded {
  std::uint32_t index;
  std::uint64_t keys;

  Padded(std::uint64_t full_index, std::uint64_t key) : keys(mix(key ^ mix(high(full_index)))) {
    const std::uint32_t shuffle = high(keys * 0xd1342543de82ef95u);
    index = reverse_bits(owen_scramble_reversed(reverse_bits(low(full_index)), shuffle));
  }
  [[nodiscard]] float x() const {
    return to_unit(reverse_bits(owen_scramble_reversed(index, low(keys))));
  }
  [[nodiscard]] float y() const {
    return to_unit(reverse_bits(owen_scramble_reversed(sobol_reversed_1(index), high(keys))));
  }
};

float sobol(std::uint64_t index, std::uint32_t dimension, std::uint64_t key) {
  const std::uint32_t bits = sobol_reversed(index, dimension);
  return to_unit(reverse_bits(owen_scramble_reversed(bits, high(mix(key)))));
}

}  // namespace

Sampler::Sampler(const SamplerSettings& settings, std::uint32_t sequence, std::uint64_t index)
    : kind_(settings.kind),
      global_(settings.enumeration == Enumeration::global),
      seed_(mix(mix(settings.seed + kGolden) + sequence)),
      index_(index) {}

std::uint64_t Sampler::take_key() {
  return seed_ + ++dimension_ * kGolden;
}

bool Sampler::from_sequence(std::uint32_t count) const {
  if (kind_ == SamplerKind::halton) return dimension_ + count <= kHaltonDimensions;
  return global_ && dimension_ + count <= kSobolDimensions;
}

float Sampler::next_1d() {
  const bool in_sequence = from_sequence(1);
  const std::uint32_t dimension = dimension_;
  const std::uint64_t key = take_key();
  if (kind_ == SamplerKind::independent) return to_unit(high(mix(key ^ mix(index_ + kGolden))));
  if (!in_sequence) return Padded(index_, key).x();
  return kind_ == SamplerKind::sobol ? sobol(index_, dimension, key)
                                     : halton(index_, dimension, mix(key));
}

Vec2 Sampler::next_2d() {
  const bool in_sequence = from_sequence(2);
  const std::uint32_t dimension = dimension_;
  const std::uint64_t key = take_key();
  const std::uint64_t key_y = take_key();
  if (kind_ == SamplerKind::independent) {
    const std::uint64_t bits = mix(key ^ mix(index_ + kGolden));
    return {to_unit(high(bits)), to_unit(low(bits))};
  }
  if (!in_sequence) {
    const Padded point(index_, key);
    return {point.x(), point.y()};
  }
  if (kind_ == SamplerKind::sobol) {
    return {sobol(index_, dimension, key), sobol(index_, dimension + 1, key_y)};
  }
  return {halton(index_, dimension, mix(key)), halton(index_, dimension + 1, mix(key_y))};
}

Sampler Sampler::split(std::uint32_t k, std::uint32_t count) const {
  // The dimensions go on where the path is, so that they differ from those that led to it; a new
  // seed keeps them apart from what the path itself still draws.
  Sampler result = *this;
  result.seed_ = mix(seed_ ^ (0x5851f42d4c957f2du + dimension_));
  result.index_ = index_ * count + k;
  return result;
}

std::uint32_t block_base(SamplerKind) {
  return 2;
}

}  // namespace psf::render
