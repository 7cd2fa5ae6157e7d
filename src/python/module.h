// What the sources of psf._psf share.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "interruptible.h"
#include "psf/psf.h"

namespace psf::python {

using Texts = std::map<std::string, std::string>;

inline Parameters parameters_of(const Texts& given, bool no_weights) {
  Parameters parameters;
  for (const auto& [name, text] : given) parameters.set(name, text);
  return parameters.no_weights(no_weights);
}

// (first, last) of Python.
using PassRange = std::pair<std::uint64_t, std::optional<std::uint64_t>>;
inline Passes to_passes(const PassRange& range) {
  return {range.first, range.second};
}

template <class Work>
auto work_on(const py::object& progress, const Work& work) {
  return interruptible<Interruptible>(progress, work);
}

// Sequence, flicker.
void bind_frames(py::module_& m);
// sweep, tune, converge, explain.
void bind_studies(py::module_& m, py::class_<Dump>& dump);
// filter_records, DumpWriter.
void bind_records(py::module_& m);

}  // namespace psf::python
