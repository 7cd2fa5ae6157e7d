#include "formats/head.h"

namespace psf::formats {

std::size_t size_of(Type type) {
  switch (type) {
    case Type::u8: return 1;
    case Type::f16:
    case Type::u16: return 2;
    case Type::u32:
    case Type::f32: return 4;
    case Type::u64:
    case Type::f64: return 8;
  }
  return 0;
}

std::string_view name_of(Type type) {
  switch (type) {
    case Type::u8: return "u8";
    case Type::u16: return "u16";
    case Type::u32: return "u32";
    case Type::u64: return "u64";
    case Type::f16: return "f16";
    case Type::f32: return "f32";
    case Type::f64: return "f64";
  }
  return "?";
}

std::optional<std::size_t> Head::find(std::string_view channel) const {
  for (std::size_t k = 0; k < channels.size(); ++k) {
    if (channels[k].name == channel) return k;
  }
  return std::nullopt;
}

}  // namespace psf::formats
