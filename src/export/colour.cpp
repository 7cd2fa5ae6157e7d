#include "export/colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "film/display.h"

namespace psf::exports {
namespace {

constexpr const char* kRadiance = "radiance";

std::uint8_t to_byte(float shown) {
  return shown > 0 ? static_cast<std::uint8_t>(std::lround(255 * std::min(shown, 1.0f))) : 0;
}

// Neighbouring numbers get colours far apart; never black.
std::array<std::uint8_t, 3> colour_of_number(std::uint64_t number) {
  std::uint64_t bits = (number + 1) * 0x9E3779B97F4A7C15u;
  bits ^= bits >> 29;
  const auto channel = [&](int shift) {
    return static_cast<std::uint8_t>(64 + (bits >> shift) % 192);
  };
  return {channel(8), channel(24), channel(40)};
}

}  // namespace

PointColours::PointColours(const ExportRecords& records, const std::string& name)
    : records_(records), radiance_(name == kRadiance && !records.schema().find(name)) {
  const formats::Schema& schema = records.schema();
  const auto place = [&](const std::string& wanted) {
    return records.find(std::array{wanted}).front();
  };
  channel_ = place(radiance_ ? "contribution" : name);
  if (radiance_) {
    throughput_ = place("throughput");
    unfiltered_ = schema.find("unfiltered");
  }
  const auto check = [&](std::size_t k, bool fits) {
    if (fits) return;
    const formats::Channel& channel = schema.channels[k];
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: no colour can be made of the channel {}, {} x {}; give `colour "
                            "none` or one of 1 or 3 floats",
                            records.path(), channel.name, formats::name_of(channel.type),
                            channel.components));
  };
  const formats::Channel& channel = schema.channels[channel_];
  components_ = channel.decoded_components();
  if (!is_float(channel)) {
    kind_ = Kind::number;
    check(channel_, components_ == 1 && !radiance_);
    return;
  }
  check(channel_, components_ == 3 || (components_ == 1 && !radiance_));
  if (throughput_) {
    const formats::Channel& other = schema.channels[*throughput_];
    check(*throughput_, is_float(other) && other.decoded_components() == 3);
  }
  if (unfiltered_) {
    const formats::Channel& other = schema.channels[*unfiltered_];
    check(*unfiltered_, is_float(other) && other.decoded_components() == 3);
  }
  if (name == "reflectance" || name == "roughness") kind_ = Kind::albedo;
  if (components_ == 3 && (name == "normal" || name == "direction" ||
                           channel.encoding == formats::Encoding::octahedral)) {
    kind_ = Kind::direction;
  }
}

void PointColours::read(std::uint64_t first, std::size_t count) {
  if (kind_ == Kind::number) return records_.read(channel_, first, count, numbers_);
  records_.read_floats(channel_, first, count, values_);
  if (throughput_) records_.read_floats(*throughput_, first, count, throughputs_);
  if (unfiltered_) records_.read_floats(*unfiltered_, first, count, unfiltereds_);
}

Rgb PointColours::linear(std::size_t k) const {
  if (components_ == 1) return Rgb(values_[k], values_[k], values_[k]);
  Rgb value(values_[3 * k], values_[3 * k + 1], values_[3 * k + 2]);
  if (throughput_) {
    value *= Rgb(throughputs_[3 * k], throughputs_[3 * k + 1], throughputs_[3 * k + 2]);
  }
  if (unfiltered_) {
    value += Rgb(unfiltereds_[3 * k], unfiltereds_[3 * k + 1], unfiltereds_[3 * k + 2]);
  }
  return value;
}

std::array<std::uint8_t, 3> PointColours::at(std::size_t k) const {
  if (kind_ == Kind::number) {
    const std::size_t size = records_.schema().channels[channel_].stride();
    std::uint64_t number = 0;
    std::memcpy(&number, numbers_.data() + k * size, size);
    return colour_of_number(number);
  }
  const Rgb value = linear(k);
  const auto shown = [&](float component) {
    if (kind_ == Kind::direction) return to_byte((component + 1) / 2);
    if (kind_ == Kind::exposed) component = film::tone_map(component * scale_);
    return to_byte(film::srgb_from_linear(component > 0 ? component : 0));
  };
  return {shown(value.x), shown(value.y), shown(value.z)};
}

void PointColours::set_exposure(float stops) {
  scale_ = std::exp2(stops);
}

std::size_t PointColours::bytes() const {
  return std::size_t{12} * (1u + (throughput_ ? 1u : 0u) + (unfiltered_ ? 1u : 0u));
}

}  // namespace psf::exports
