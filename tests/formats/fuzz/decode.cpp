// Fuzzes the decoding of columns: zstd, shuffle, octahedral directions, half floats.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/error.h"
#include "formats/layout/codec.h"
#include "formats/layout/quantize.h"
#include "targets.h"

namespace psf::fuzz {
namespace {

template <class T>
std::vector<T> values_of(Bytes bytes, std::size_t multiple) {
  std::vector<T> values(bytes.size() / sizeof(T) / multiple * multiple);
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

void decode_stored(Bytes stored, formats::Filter filter, std::size_t size) {
  std::vector<std::byte> out(size);
  try {
    formats::decode_zstd(stored, filter, out);
  } catch (const Error& error) {
    demand(error.code() == ErrorCode::bad_input, "bad bytes are bad input");
    return;
  }
  // What decodes is what would be written again, if not in the same bytes.
  formats::Buffer storage;
  const auto again = formats::encode_column(formats::Codec::zstd, out, storage);
  if (again.codec == formats::Codec::raw) return;
  std::vector<std::byte> second(size);
  formats::decode_zstd(again.bytes, again.filter, second);
  demand(out == second, "what was encoded decodes to what it was");
}

void shuffle(Bytes bytes) {
  std::vector<std::byte> there(bytes.size()), back(bytes.size());
  formats::shuffle4(bytes, there);
  formats::unshuffle4(there, back);
  demand(std::equal(back.begin(), back.end(), bytes.begin()), "unshuffle undoes shuffle");
}

void demand_unit_or_marked(const float* v) {
  const double length_sq = double{v[0]} * v[0] + double{v[1]} * v[1] + double{v[2]} * v[2];
  demand(length_sq == 0 || std::isnan(length_sq) || std::abs(length_sq - 1) < 1e-5,
         "a direction has length 1, or is zero, or is no number");
}

void octahedral(Bytes bytes) {
  const auto codes = values_of<std::uint16_t>(bytes, 2);
  std::vector<float> vectors(codes.size() / 2 * 3);
  formats::decode_octahedral(codes, vectors);
  for (std::size_t k = 0; k < vectors.size(); k += 3) demand_unit_or_marked(&vectors[k]);

  auto any = values_of<float>(bytes, 3);
  std::vector<std::uint16_t> encoded(any.size() / 3 * 2);
  formats::encode_octahedral(any, encoded);
  formats::decode_octahedral(encoded, any);
  for (std::size_t k = 0; k < any.size(); k += 3) demand_unit_or_marked(&any[k]);
}

void half(Bytes bytes) {
  const auto halves = values_of<std::uint16_t>(bytes, 1);
  std::vector<float> values(halves.size());
  formats::decode_half(halves, values);
  std::vector<std::uint16_t> again(halves.size());
  formats::encode_half(values, again);
  for (std::size_t k = 0; k < halves.size(); ++k) {
    demand(again[k] == halves[k] || std::isnan(values[k]), "a half is exact as a float");
  }
  const auto any = values_of<float>(bytes, 1);
  again.resize(any.size());
  formats::encode_half(any, again);
}

}  // namespace

void fuzz_decode(Bytes bytes) {
  if (bytes.size() < 3) return;
  const auto what = std::to_integer<unsigned>(bytes[0]);
  const std::size_t size =
      std::to_integer<std::size_t>(bytes[1]) | std::to_integer<std::size_t>(bytes[2]) << 8;
  const Bytes rest = bytes.subspan(3);
  switch (what % 5) {
    case 0:
      return decode_stored(rest, formats::Filter::none, size);
    case 1:
      return decode_stored(rest, formats::Filter::shuffle4, size);
    case 2:
      return shuffle(rest);
    case 3:
      return octahedral(rest);
    default:
      return half(rest);
  }
}

}  // namespace psf::fuzz
