// Sequences of frames: filtered frame by frame, and their flicker.
#include <pybind11/stl.h>

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "module.h"

namespace psf::python {
namespace {

FilterResult filter_frame(const Sequence& sequence, std::uint32_t frame, const Texts& given,
                          bool no_weights, std::uint32_t window, const std::string& relit,
                          const std::string& positions, std::optional<std::uint64_t> max_memory,
                          const std::string& vertex, const py::object& progress) {
  const Parameters parameters = parameters_of(given, no_weights);
  return work_on(progress, [&](const auto& on_progress) {
    return sequence.filter(frame, parameters,
                           {window, relit, positions, true, max_memory, vertex, on_progress});
  });
}

// Files, pictures, label of a PictureSequence.
using PictureList = std::tuple<std::string, std::vector<Picture>, std::string>;
PictureSequence to_sequence(const PictureList& list) {
  const auto& [files, pictures, label] = list;
  return {files, pictures, label};
}

FlickerResult flicker(const std::vector<PictureList>& lists, const PictureList& reference,
                      std::uint32_t first, std::optional<std::uint32_t> last, double epsilon,
                      double trim, float exposure, std::size_t columns,
                      const py::object& progress) {
  std::vector<PictureSequence> sequences;
  sequences.reserve(lists.size());
  for (const PictureList& list : lists) sequences.push_back(to_sequence(list));
  return work_on(progress, [&](const auto& on_progress) {
    return psf::flicker(sequences, to_sequence(reference),
                        {first, last, epsilon, trim, exposure, columns, on_progress});
  });
}

py::list rows_of(const FlickerResult& result) {
  py::list rows;
  for (const FlickerRow& row : result.rows) {
    py::dict values;
    values["label"] = row.label;
    values["error"] = row.error;
    values["flicker"] = row.flicker;
    values["left_out"] = row.left_out;
    rows.append(values);
  }
  return rows;
}

}  // namespace

void bind_frames(py::module_& m) {
  py::class_<Sequence>(m, "Sequence")
      .def(py::init<const std::string&>(), py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("path", &Sequence::path)
      .def_property_readonly("frames", &Sequence::frames)
      .def_property_readonly("cameras", &Sequence::cameras)
      .def("filter", filter_frame);
  m.def("flicker", flicker);
  py::class_<FlickerResult>(m, "FlickerResult")
      .def_readonly("json", &FlickerResult::json)
      .def_property_readonly("rows", rows_of)
      .def_property_readonly("png",
                             [](const FlickerResult& result) {
                               return py::bytes(reinterpret_cast<const char*>(result.png.data()),
                                                result.png.size());
                             })
      .def("save", &FlickerResult::save, py::call_guard<py::gil_scoped_release>());
}

}  // namespace psf::python
