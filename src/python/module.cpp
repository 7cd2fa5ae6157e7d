// The Python module psf._psf: the library's functions on numpy arrays. Names, defaults and text for
// people are in psf/__init__.py.
#include "module.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <tuple>
#include <vector>

#include "arrays.h"

namespace psf::python {
namespace {

py::dtype dtype_of(const Channel& channel) {
  return py::dtype((channel.type[0] == 'f' ? "<f" : "<u") +
                   std::to_string(std::stoi(channel.type.substr(1)) / 8));
}

// Records [first, first + count) of a channel: (count) or (count, components).
py::array read_channel(const Dump& dump, const Channel& channel, std::uint64_t first,
                       std::uint64_t count) {
  const auto rows = static_cast<py::ssize_t>(count);
  if (channel.octahedral) {
    py::array_t<float> vectors({rows, py::ssize_t{3}});
    const std::span<float> out(vectors.mutable_data(), 3 * count);
    const py::gil_scoped_release released;
    dump.read_floats(channel.name, first, count, out);
    return vectors;
  }
  const auto components = static_cast<py::ssize_t>(channel.components);
  py::array values(dtype_of(channel), components == 1 ? std::vector<py::ssize_t>{rows}
                                                      : std::vector<py::ssize_t>{rows, components});
  const std::span<std::byte> out(static_cast<std::byte*>(values.mutable_data()),
                                 static_cast<std::size_t>(values.nbytes()));
  const py::gil_scoped_release released;
  dump.read(channel.name, first, count, out);
  return values;
}

void bind_values(py::module_& m) {
  py::class_<Channel>(m, "Channel")
      .def_readonly("name", &Channel::name)
      .def_readonly("type", &Channel::type)
      .def_readonly("components", &Channel::components)
      .def_readonly("octahedral", &Channel::octahedral)
      .def_property_readonly("dtype", dtype_of);

  py::class_<Camera>(m, "Camera")
      .def(py::init([](std::string name, std::uint32_t width, std::uint32_t height, double angle) {
             return Camera{std::move(name), width, height, angle};
           }),
           py::arg("name"), py::arg("width"), py::arg("height"), py::arg("angle_per_pixel") = 0.0)
      .def_readonly("name", &Camera::name)
      .def_readonly("width", &Camera::width)
      .def_readonly("height", &Camera::height)
      .def_readonly("angle_per_pixel", &Camera::angle_per_pixel);
}

void bind_picture(py::module_& m) {
  py::class_<Picture>(m, "Picture")
      .def_readonly("width", &Picture::width)
      .def_readonly("height", &Picture::height)
      .def_readonly("camera", &Picture::camera)
      .def_property_readonly("attributes",
                             [](const Picture& picture) {
                               py::dict all;
                               for (const auto& [name, text] : picture.attributes) {
                                 all[py::str(name)] = text;
                               }
                               return all;
                             })
      .def_property_readonly("layer_names",
                             [](const Picture& picture) {
                               std::vector<std::string> names;
                               for (const Layer& layer : picture.layers) {
                                 names.push_back(layer.name);
                               }
                               return names;
                             })
      // A view of the picture's own memory.
      .def("layer",
           [](const py::object& self, const std::string& name) {
             const auto& picture = self.cast<const Picture&>();
             const std::vector<float>& values = picture.layer(name);
             return py::array_t<float>({static_cast<py::ssize_t>(picture.height),
                                        static_cast<py::ssize_t>(picture.width)},
                                       values.data(), self);
           })
      .def(
          "rgb",
          [](const Picture& picture, const std::string& prefix) {
            return adopt(picture.rgb(prefix), {static_cast<py::ssize_t>(picture.height),
                                               static_cast<py::ssize_t>(picture.width), 3});
          },
          py::arg("prefix") = "")
      .def("png",
           [](const Picture& picture, float exposure) {
             const std::vector<unsigned char> file = picture.png(exposure);
             return py::bytes(reinterpret_cast<const char*>(file.data()), file.size());
           })
      .def_property_readonly("light_layers", &Picture::light_layers)
      .def("relight", &Picture::relight, py::arg("weights"),
           py::call_guard<py::gil_scoped_release>())
      .def("save", &Picture::save, py::call_guard<py::gil_scoped_release>())
      .def_static("read", &Picture::read, py::arg("path"), py::arg("layer") = "",
                  py::call_guard<py::gil_scoped_release>())
      .def("error", &Picture::error, py::call_guard<py::gil_scoped_release>());
}

}  // namespace

PYBIND11_MODULE(_psf, m) {
  m.attr("version") = PSF_VERSION;
  static const py::exception<Error> kError(m, "Error");
  py::register_exception_translator(translate);
  end_at_exit(interrupt);

  m.def("parameters", [] {
    std::vector<std::tuple<std::string, std::string, std::string, std::string>> all;
    for (const ParameterHelp& one : Parameters::help()) {
      all.emplace_back(one.name, one.type, one.help, one.standard);
    }
    return all;
  });
  m.def("metric_names", metric_names);

  bind_values(m);
  bind_picture(m);
  py::class_<FilterResult>(m, "FilterResult")
      .def("take_pictures", [](FilterResult& result) { return std::move(result.pictures); })
      .def_readonly("notes", &FilterResult::notes)
      .def_readonly("passes", &FilterResult::passes)
      .def_readonly("blocks", &FilterResult::blocks)
      .def_readonly("sources", &FilterResult::sources)
      .def_readonly("queries", &FilterResult::queries)
      .def_readonly("orphans", &FilterResult::orphans)
      .def_readonly("left_out", &FilterResult::left_out)
      .def_readonly("neighbors", &FilterResult::neighbors);

  py::class_<Dump> dump(m, "Dump");
  dump.def(py::init<const std::string&>(), py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("path", &Dump::path)
      .def_property_readonly("records", &Dump::records)
      .def_property_readonly("passes", &Dump::passes)
      .def_property_readonly("closed", &Dump::closed)
      .def_property_readonly("metadata", &Dump::metadata)
      .def_property_readonly("channels", &Dump::channels)
      .def_property_readonly("cameras", &Dump::cameras)
      .def("refresh", &Dump::refresh)
      .def("read", read_channel)
      .def("filter", [](const Dump& dump, const Texts& given, bool no_weights,
                        const PassRange& passes, std::optional<std::uint64_t> max_memory,
                        const std::string& vertex, const py::object& progress) {
        const Parameters parameters = parameters_of(given, no_weights);
        return work_on(progress, [&](const auto& on_progress) {
          FilterOptions options;
          options.passes = to_passes(passes);
          options.max_memory = max_memory;
          options.vertex = vertex;
          options.on_progress = on_progress;
          return dump.filter(parameters, options);
        });
      });

  bind_frames(m);
  bind_studies(m, dump);
  bind_records(m);
}

}  // namespace psf::python
