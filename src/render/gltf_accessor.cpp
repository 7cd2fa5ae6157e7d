// Typed values out of the buffers of a glTF file, every bound checked.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "formats/error.h"
#include "render/gltf_parts.h"

namespace psf::render {
namespace {

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
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return get(std::int8_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return get(std::uint8_t{});
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return get(std::int16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return get(std::uint16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return get(std::uint32_t{});
    default: {  // float
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

Elements elements(const GltfLoad& load, int buffer_view, std::size_t offset, std::size_t count,
                  std::size_t components, int type, const std::string& place) {
  const auto bytes = bytes_of(load, buffer_view, place);
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type));
  const bool known = type >= TINYGLTF_COMPONENT_TYPE_BYTE &&
                     type <= TINYGLTF_COMPONENT_TYPE_FLOAT && type != TINYGLTF_COMPONENT_TYPE_INT &&
                     size > 0;
  if (!known) load.fail(place, fmt::format("componentType {} is none of glTF's", type));
  Elements result;
  result.component_size = static_cast<std::size_t>(size);
  const std::size_t element = result.component_size * components;
  const std::size_t stride =
      load.model.bufferViews[static_cast<std::size_t>(buffer_view)].byteStride;
  result.stride = stride == 0 ? element : stride;
  if (result.stride < element) load.fail(place, "byteStride is smaller than an element");
  const bool fits =
      count == 0 || (offset <= bytes.size() && element <= bytes.size() - offset &&
                     (count - 1) <= (bytes.size() - offset - element) / result.stride);
  if (!fits) {
    load.fail(place, fmt::format("{} elements do not fit into the {} bytes of bufferView {}", count,
                                 bytes.size(), buffer_view));
  }
  result.first = bytes.data() + offset;
  return result;
}

const tinygltf::Accessor& accessor_at(const GltfLoad& load, int index, const std::string& place) {
  if (index < 0 || static_cast<std::size_t>(index) >= load.model.accessors.size()) {
    load.fail(place, fmt::format("there is no accessor {}", index));
  }
  return load.model.accessors[static_cast<std::size_t>(index)];
}

// Calls store(element, component, value) for all of an accessor, the sparse ones afterwards.
template <typename Store>
void read(const GltfLoad& load, const tinygltf::Accessor& accessor, std::size_t components,
          const std::string& place, Store store) {
  const auto each = [&](const Elements& e, std::size_t count, auto target) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < components; ++c) {
        store(target(i), c,
              component_at(e.first + i * e.stride + c * e.component_size, accessor.componentType,
                           accessor.normalized));
      }
    }
  };
  if (accessor.bufferView >= 0) {
    each(elements(load, accessor.bufferView, accessor.byteOffset, accessor.count, components,
                  accessor.componentType, place),
         accessor.count, [](std::size_t i) { return i; });
  }
  if (!accessor.sparse.isSparse) return;
  const auto& sparse = accessor.sparse;
  if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
    load.fail(place, "a negative number in \"sparse\"");
  }
  const auto count = static_cast<std::size_t>(sparse.count);
  const Elements where =
      elements(load, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
               count, 1, sparse.indices.componentType, place);
  const Elements what =
      elements(load, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
               count, components, accessor.componentType, place);
  each(what, count, [&](std::size_t i) {
    const double target =
        component_at(where.first + i * where.stride, sparse.indices.componentType, false);
    if (!(target >= 0 && target < static_cast<double>(accessor.count))) {
      load.fail(place,
                fmt::format("\"sparse\" names element {}, there are {}", target, accessor.count));
    }
    return static_cast<std::size_t>(target);
  });
}

// Before anything is allocated: an accessor without bufferView may claim any count.
void check_count(const GltfLoad& load, const tinygltf::Accessor& accessor,
                 const std::string& place) {
  if (accessor.count > kMaxPrimitives * 3) {
    throw Error(ErrorCode::limit,
                fmt::format("{}: {}: {} elements are more than psf takes ({})", load.path, place,
                            accessor.count, kMaxPrimitives * 3));
  }
}

}  // namespace

std::span<const unsigned char> bytes_of(const GltfLoad& load, int buffer_view,
                                        const std::string& place) {
  const tinygltf::Model& model = load.model;
  if (buffer_view < 0 || static_cast<std::size_t>(buffer_view) >= model.bufferViews.size()) {
    load.fail(place, fmt::format("there is no bufferView {}", buffer_view));
  }
  const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(buffer_view)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size()) {
    load.fail(fmt::format("/bufferViews/{}", buffer_view),
              fmt::format("there is no buffer {}", view.buffer));
  }
  const auto& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) {
    load.fail(fmt::format("/bufferViews/{}", buffer_view),
              fmt::format("bytes {} to {} reach outside buffer {}, which has {}", view.byteOffset,
                          view.byteOffset + view.byteLength, view.buffer, data.size()));
  }
  return {data.data() + view.byteOffset, view.byteLength};
}

std::vector<float> read_floats(const GltfLoad& load, int index, std::size_t components,
                               const std::string& place) {
  const tinygltf::Accessor& accessor = accessor_at(load, index, place);
  const int found = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  if (found != static_cast<int>(components)) {
    load.fail(place,
              fmt::format("accessor {} has {} components, expected {}", index, found, components));
  }
  check_count(load, accessor, place);
  std::vector<float> values(accessor.count * components);
  read(load, accessor, components, place, [&](std::size_t i, std::size_t c, double value) {
    values[i * components + c] = static_cast<float>(value);
  });
  return values;
}

std::vector<std::uint32_t> read_indices(const GltfLoad& load, int index, const std::string& place) {
  const tinygltf::Accessor& accessor = accessor_at(load, index, place);
  if (accessor.type != TINYGLTF_TYPE_SCALAR ||
      accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) {
    load.fail(place, fmt::format("accessor {} does not hold indices", index));
  }
  check_count(load, accessor, place);
  std::vector<std::uint32_t> values(accessor.count);
  read(load, accessor, 1, place, [&](std::size_t i, std::size_t, double value) {
    if (value < 0) load.fail(place, fmt::format("index {} is negative", i));
    values[i] = static_cast<std::uint32_t>(value);
  });
  return values;
}

}  // namespace psf::render
