// Records in memory and dumps that are written.
#include <pybind11/stl.h>

#include <tuple>
#include <vector>

#include "arrays.h"
#include "module.h"

namespace psf::python {

void bind_records(py::module_& m) {
  m.def(
      "filter_records",
      [](const std::vector<Camera>& cameras, const Texts& given, bool no_weights, double n,
         const py::object& progress, const Column<float>& position, const Column<float>& throughput,
         const Column<float>& contribution, const Column<std::uint32_t>& pixel,
         const Column<float>& distance, const Column<float>& unfiltered,
         const Column<float>& normal, const Column<float>& reflectance,
         const Column<float>& direction, const Column<float>& hit_distance,
         const Column<float>& roughness, const Column<std::uint32_t>& visibility,
         const Column<std::uint32_t>& material, const Column<std::uint16_t>& camera,
         const Column<std::uint8_t>& flags, const Column<std::uint8_t>& kind) {
        const Parameters parameters = parameters_of(given, no_weights);
        Records records;
        records.position = span_of(position);
        records.throughput = span_of(throughput);
        records.contribution = span_of(contribution);
        records.pixel = span_of(pixel);
        records.distance = span_of(distance);
        records.unfiltered = span_of(unfiltered);
        records.normal = span_of(normal);
        records.reflectance = span_of(reflectance);
        records.direction = span_of(direction);
        records.hit_distance = span_of(hit_distance);
        records.roughness = span_of(roughness);
        records.visibility = span_of(visibility);
        records.material = span_of(material);
        records.camera = span_of(camera);
        records.flags = span_of(flags);
        records.kind = span_of(kind);
        FilteredRecords done = work_on(progress, [&](const auto& on_progress) {
          // One block: there is no more to tell than its beginning and its end.
          on_progress(0, records.pixel.size());
          FilteredRecords filtered = filter_records(records, cameras, parameters, n);
          on_progress(records.pixel.size(), records.pixel.size());
          return filtered;
        });
        const auto count = static_cast<py::ssize_t>(done.neighbors.size());
        return py::make_tuple(adopt(std::move(done.c_bar), {count, 3}),
                              adopt(std::move(done.neighbors), {count}),
                              adopt(std::move(done.radius), {count}), std::move(done.pictures));
      });

  py::class_<DumpWriter>(m, "DumpWriter")
      .def(py::init(
          [](const std::string& path, const std::vector<Camera>& cameras,
             const std::vector<std::tuple<std::string, std::string, std::size_t, bool>>& channels,
             bool compress, const std::string& metadata) {
            std::vector<Channel> all;
            all.reserve(channels.size());
            for (const auto& [name, type, components, octahedral] : channels) {
              all.push_back({name, type, components, octahedral});
            }
            return DumpWriter(path, cameras, all, {compress, metadata});
          }))
      .def_property_readonly("channels", &DumpWriter::channels)
      .def_property_readonly("records", &DumpWriter::records)
      .def_property_readonly("passes", &DumpWriter::passes)
      // Arrays of the channels' types, contiguous, of `count` rows: __init__.py sees to it.
      .def("append",
           [](DumpWriter& writer, std::size_t count, const std::vector<py::array>& arrays) {
             std::vector<const void*> columns;
             columns.reserve(arrays.size());
             for (const py::array& array : arrays) columns.push_back(array.data());
             const py::gil_scoped_release released;
             writer.append(count, columns);
           })
      .def("commit_pass", &DumpWriter::commit_pass, py::call_guard<py::gil_scoped_release>())
      .def("close", &DumpWriter::close, py::call_guard<py::gil_scoped_release>());
}

}  // namespace psf::python
