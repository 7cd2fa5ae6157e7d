// Typed values out of the buffers of a glTF file, every bound checked.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "render/scene/gltf/parts.h"

namespace psf::render {
namespace {

// componentType of an accessor.
constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
              kUnsignedInt = 5125, kFloat = 5126;

// Most elements of an accessor without bufferView, which are 0 but for the sparse ones.
constexpr std::size_t kMaxZeros = std::size_t{1} << 24;

std::size_t size_of(int component_type) {
  return component_type <= kUnsignedByte ? 1 : component_type <= kUnsignedShort ? 2 : 4;
}

// One component at `bytes` as a number.
double component_at(const unsigned char* bytes, int type, bool normalized) {
  const auto get = [&]<typename T>(T) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    const double scale = normalized ? 1.0 / std::numeric_limits<T>::max() : 1.0;
    return std::max(static_cast<double>(value) * scale,
                    normalized ? -1.0 : std::numeric_limits<double>::lowest());
  };
  switch (type) {
    case kByte:
      return get(std::int8_t{});
    case kUnsignedByte:
      return get(std::uint8_t{});
    case kShort:
      return get(std::int16_t{});
    case kUnsignedShort:
      return get(std::uint16_t{});
    case kUnsignedInt:
      return get(std::uint32_t{});
    default: {
      float value = 0;
      std::memcpy(&value, bytes, sizeof value);
      return static_cast<double>(value);
    }
  }
}

// `count` elements of `components` from `offset` on in a buffer view.
struct Elements {
  const unsigned char* first = nullptr;
  std::size_t stride = 0, component_size = 0;
};

// The elements that an object with "bufferView" and "byteOffset" describes.
Elements elements(GltfLoad& load, const JsonCursor& json, std::size_t count, std::size_t components,
                  int type) {
  const JsonCursor index = json.at("bufferView");
  const auto bytes = bytes_of(load, index);
  const JsonCursor view = load.element("bufferViews", index, "bufferView");
  const auto offset_json = json.find("byteOffset"), stride = view.find("byteStride");
  const std::uint64_t offset = offset_json ? offset_json->whole() : 0;
  Elements result;
  result.component_size = size_of(type);
  const std::size_t element = result.component_size * components;
  result.stride = stride ? static_cast<std::size_t>(stride->whole(1 << 20)) : element;
  if (result.stride < element)
    stride->fail(fmt::format("is smaller than an element of {} bytes", element));
  const bool fits =
      count == 0 || (offset <= bytes.size() && element <= bytes.size() - offset &&
                     (count - 1) <= (bytes.size() - offset - element) / result.stride);
  if (!fits) {
    json.fail(fmt::format("{} elements do not fit into the {} bytes of bufferView {}", count,
                          bytes.size(), index.whole()));
  }
  result.first = bytes.data() + offset;
  return result;
}

struct Accessor {
  JsonCursor json;
  int type = kFloat;  // type of the components
  bool normalized = false;
  std::size_t count = 0, components = 0;
};

int component_type(const JsonCursor& json) {
  const std::uint64_t type = json.whole();
  const bool known = type >= kByte && type <= kFloat && type != 5124;
  if (!known) json.fail(fmt::format("componentType {} is none of glTF's", type));
  return static_cast<int>(type);
}

Accessor accessor_at(GltfLoad& load, const JsonCursor& index) {
  static constexpr std::string_view kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4",
                                                "MAT2",   "MAT3", "MAT4"};
  static constexpr std::size_t kComponents[] = {1, 2, 3, 4, 4, 9, 16};
  Accessor a{load.element("accessors", index, "accessor")};
  load.check_keys(a.json, {"bufferView", "byteOffset", "componentType", "normalized", "count",
                           "type", "max", "min", "sparse"});
  a.type = component_type(a.json.at("componentType"));
  if (const auto normalized = a.json.find("normalized")) a.normalized = normalized->boolean();
  a.components = kComponents[a.json.at("type").choice(kTypes)];
  const std::uint64_t count = a.json.at("count").whole();
  // Before anything is allocated: without bufferView no byte of the file stands behind the count.
  const std::size_t most = a.json.find("bufferView") ? kMaxPrimitives * 3 : kMaxZeros;
  if (count > most) {
    throw Error(ErrorCode::limit,
                fmt::format("{}: {} elements{} are more than psf takes ({})", a.json.where(), count,
                            most == kMaxZeros ? " without bufferView" : "", most));
  }
  a.count = static_cast<std::size_t>(count);
  return a;
}

// Calls store(element, component, value) for all of an accessor, the sparse ones afterwards.
template <typename Store>
void read(GltfLoad& load, const Accessor& a, Store store) {
  const auto each = [&](const Elements& e, std::size_t count, auto target) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < a.components; ++c) {
        store(target(i), c,
              component_at(e.first + i * e.stride + c * e.component_size, a.type, a.normalized));
      }
    }
  };
  if (a.json.find("bufferView")) {
    each(elements(load, a.json, a.count, a.components, a.type), a.count,
         [](std::size_t i) { return i; });
  }
  const auto sparse = a.json.find("sparse");
  if (!sparse) return;
  const auto count = static_cast<std::size_t>(sparse->at("count").whole());
  const JsonCursor indices = sparse->at("indices");
  const int index_type = component_type(indices.at("componentType"));
  const Elements where = elements(load, indices, count, 1, index_type);
  const Elements what = elements(load, sparse->at("values"), count, a.components, a.type);
  each(what, count, [&](std::size_t i) {
    const double target = component_at(where.first + i * where.stride, index_type, false);
    if (!(target >= 0 && target < static_cast<double>(a.count)))
      indices.fail(fmt::format("names element {}, there are {}", target, a.count));
    return static_cast<std::size_t>(target);
  });
}

}  // namespace

std::vector<float> read_floats(GltfLoad& load, const JsonCursor& index, std::size_t components) {
  const Accessor a = accessor_at(load, index);
  if (a.components != components) {
    index.fail(fmt::format("accessor {} has {} components, expected {}", index.whole(),
                           a.components, components));
  }
  std::vector<float> values(a.count * components);
  read(load, a, [&](std::size_t i, std::size_t c, double value) {
    values[i * components + c] = static_cast<float>(value);
  });
  return values;
}

std::vector<std::uint32_t> read_indices(GltfLoad& load, const JsonCursor& index) {
  const Accessor a = accessor_at(load, index);
  if (a.components != 1 || a.type == kFloat)
    index.fail(fmt::format("accessor {} does not hold indices", index.whole()));
  if (a.normalized)
    index.fail(fmt::format("accessor {} is normalized, which indices are not", index.whole()));
  std::vector<std::uint32_t> values(a.count);
  read(load, a, [&](std::size_t i, std::size_t, double value) {
    if (value < 0) index.fail(fmt::format("index {} is negative", i));
    values[i] = static_cast<std::uint32_t>(value);
  });
  return values;
}

}  // namespace psf::render
