// Studies of dumps: sweep, tune, converge, explain. Figures are the JSON of the commands.
#include <pybind11/stl.h>

#include <array>
#include <tuple>
#include <vector>

#include "module.h"

namespace psf::python {
namespace {

void put(py::dict& row, const ParameterTexts& parameters) {
  for (const auto& [name, text] : parameters) row[py::str(name)] = text;
}

// A flat row for tables.
py::dict to_dict(const SweepRow& row) {
  py::dict values;
  put(values, row.parameters);
  for (const auto& [name, error] : row.errors) values[py::str(name)] = error;
  values["neighbors"] = row.neighbors;
  values["seconds"] = row.seconds;
  return values;
}
py::dict to_dict(const TuneRow& row) {
  py::dict values;
  put(values, row.parameters);
  values["error"] = row.error;
  values["standard_error"] = row.standard_error;
  values["bias_sq"] = row.bias_sq;
  values["variance"] = row.variance;
  values["neighbors"] = row.neighbors;
  values["sigmas_above_least"] = row.sigmas_above_least;
  values["may_be_better"] = row.may_be_better;
  return values;
}
py::dict to_dict(const AblationRow& row) {
  py::dict values;
  values["part"] = row.part;
  values["label"] = row.label;
  put(values, row.parameters);
  values["first_pass"] = row.first_pass;
  values["passes"] = row.passes;
  for (const auto& [name, error] : row.errors) values[py::str(name)] = error;
  values["mean"] = row.mean;
  values["change"] = row.change;
  values["neighbors"] = row.neighbors;
  values["seconds"] = row.seconds;
  return values;
}
py::dict to_dict(const ConvergeRow& row) {
  py::dict values;
  values["id"] = row.id;
  put(values, row.parameters);
  values["n"] = row.n;
  for (const auto& [name, value] : row.values) values[py::str(name)] = value;
  return values;
}
template <class Row>
py::list to_list(const std::vector<Row>& rows) {
  py::list list;
  for (const Row& row : rows) list.append(to_dict(row));
  return list;
}

// Rows, notes.
auto sweep(const Dump& dump, const Picture& reference, const Texts& lists, bool no_weights,
           const std::vector<std::string>& metrics, const PassRange& passes,
           std::optional<std::uint64_t> max_memory, std::size_t camera, const std::string& vertex,
           const py::object& progress) {
  const std::vector<Parameters> sets = Parameters::combinations(lists, no_weights);
  const SweepResult result = work_on(progress, [&](const auto& on_progress) {
    FilterOptions options;
    options.passes = to_passes(passes);
    options.max_memory = max_memory;
    options.vertex = vertex;
    options.on_progress = on_progress;
    return dump.sweep(reference, sets, metrics, options, camera);
  });
  return std::make_tuple(to_list(result.rows), result.notes);
}

TuneResult tune(const Dump& dump, Texts lists, bool no_weights, const PassRange& passes,
                std::size_t camera, double epsilon, std::optional<std::uint64_t> max_memory,
                const std::string& vertex, const py::object& progress) {
  lists.try_emplace("r0", tune_radii());
  const std::vector<Parameters> sets = Parameters::combinations(lists, no_weights);
  return work_on(progress, [&](const auto& on_progress) {
    return dump.tune(sets, {to_passes(passes), camera, epsilon, max_memory, vertex, on_progress});
  });
}

ConvergeResult converge(const std::vector<std::string>& dumps, const Picture& reference,
                        const Texts& lists, bool no_weights, std::optional<std::uint64_t> passes,
                        std::size_t camera, double epsilon, bool all_metrics, bool times,
                        const std::vector<std::string>& render_json,
                        std::optional<std::uint64_t> max_memory, const std::string& vertex,
                        const py::object& progress) {
  const std::vector<Parameters> sets = Parameters::combinations(lists, no_weights);
  return work_on(progress, [&](const auto& on_progress) {
    return psf::converge(dumps, reference, sets,
                         {passes, camera, epsilon, all_metrics, times, render_json, max_memory,
                          vertex, on_progress});
  });
}

AblationResult ablate(const Dump& dump, const Texts& given, bool no_weights,
                      const PassRange& passes, std::size_t camera,
                      const std::optional<Picture>& reference, const std::string& metric,
                      double epsilon, float exposure, const std::array<std::size_t, 4>& crop,
                      std::size_t columns, std::optional<std::uint64_t> max_memory,
                      const std::string& vertex, const py::object& progress) {
  const Parameters parameters = parameters_of(given, no_weights);
  return work_on(progress, [&](const auto& on_progress) {
    return dump.ablate(parameters, {to_passes(passes), camera, reference, metric, epsilon, exposure,
                                    crop, columns, max_memory, vertex, on_progress});
  });
}

using Pixel = std::tuple<std::uint32_t, std::uint32_t>;
Explanation explain(const Dump& dump, const std::optional<Pixel>& pixel, std::uint64_t path,
                    const Texts& given, bool no_weights, const PassRange& passes,
                    std::size_t camera, const std::string& vertex, const py::object& progress) {
  const Parameters parameters = parameters_of(given, no_weights);
  return work_on(progress, [&](const auto& on_progress) {
    const ExplainOptions options = {to_passes(passes), camera, vertex, on_progress};
    if (!pixel) return dump.explain_path(path, parameters, options);
    return dump.explain(std::get<0>(*pixel), std::get<1>(*pixel), parameters, options);
  });
}

}  // namespace

void bind_studies(py::module_& m, py::class_<Dump>& dump) {
  dump.def("sweep", sweep).def("tune", tune).def("ablate", ablate).def("explain", explain);
  m.def("converge", converge);
  py::class_<TuneResult>(m, "TuneResult")
      .def_readonly("json", &TuneResult::json)
      .def_property_readonly("rows", [](const TuneResult& result) { return to_list(result.rows); })
      .def_property_readonly("best", [](const TuneResult& result) { return result.best.given(); })
      .def_readonly("notes", &TuneResult::notes)
      .def("save", &TuneResult::save, py::call_guard<py::gil_scoped_release>());
  py::class_<AblationResult>(m, "AblationResult")
      .def_readonly("json", &AblationResult::json)
      .def_property_readonly("rows",
                             [](const AblationResult& result) { return to_list(result.rows); })
      .def("take_pictures",
           [](AblationResult& result) {
             std::vector<Picture> pictures;
             for (AblationRow& row : result.rows) pictures.push_back(std::move(row.picture));
             return pictures;
           })
      .def_property_readonly("png",
                             [](const AblationResult& result) {
                               return py::bytes(reinterpret_cast<const char*>(result.png.data()),
                                                result.png.size());
                             })
      .def_readonly("notes", &AblationResult::notes)
      .def("save", &AblationResult::save, py::call_guard<py::gil_scoped_release>());
  py::class_<ConvergeResult>(m, "ConvergeResult")
      .def_readonly("json", &ConvergeResult::json)
      .def_property_readonly("rows",
                             [](const ConvergeResult& result) { return to_list(result.rows); })
      .def_readonly("notes", &ConvergeResult::notes)
      .def("save", &ConvergeResult::save, py::call_guard<py::gil_scoped_release>());
  py::class_<Explanation>(m, "Explanation")
      .def("text", &Explanation::text)
      .def("whole_text", &Explanation::whole_text)
      .def("json", &Explanation::json, py::call_guard<py::gil_scoped_release>())
      .def("notes", &Explanation::notes)
      .def("save", &Explanation::save, py::call_guard<py::gil_scoped_release>());
}

}  // namespace psf::python
