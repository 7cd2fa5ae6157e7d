// Arrays of numpy on memory of the library.
#pragma once

#include <pybind11/numpy.h>

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace psf::python {

namespace py = pybind11;

// An array with the vector's memory, which it keeps.
template <class T>
py::array_t<T> adopt(std::vector<T>&& values, const std::vector<py::ssize_t>& shape) {
  auto* kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return py::array_t<T>(shape, kept->data(), owner);
}

// The values of a column, of the right type and shape: __init__.py sees to it.
template <class T>
using Column = std::optional<py::array_t<T, py::array::c_style>>;
template <class T>
std::span<const T> span_of(const Column<T>& column) {
  if (!column) return {};
  return {column->data(), static_cast<std::size_t>(column->size())};
}

}  // namespace psf::python
