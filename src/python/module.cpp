// The Python module psf._psf: the library's functions on numpy arrays. Names, defaults and text for
// people are in psf/__init__.py.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <thread>

#include "psf/psf.h"

namespace py = pybind11;

namespace {

using Texts = std::map<std::string, std::string>;

psf::Parameters parameters_of(const Texts& given, bool no_weights) {
  psf::Parameters parameters;
  for (const auto& [name, text] : given) parameters.set(name, text);
  return parameters.no_weights(no_weights);
}

// Calls at work, for the end of the interpreter.
std::atomic<int> at_work{0};

// Does long work without the interpreter lock, on a thread of its own: meanwhile this one looks for
// ^C and hands on progress. What Python raises ends the work first: ^C ends all calls, what
// `progress` raises ends this one.
template <class Work>
auto interruptible(const py::object& progress, const Work& work) {
  std::atomic<std::uint64_t> done{0}, total{0};
  std::atomic<bool> stopped{false}, finished{false};
  const auto on_progress = [&](std::uint64_t now, std::uint64_t all) {
    if (stopped) throw psf::Error(psf::ErrorCode::interrupted, "stopped by what progress raised");
    total = all;
    done = now;
  };
  std::optional<decltype(work(on_progress))> result;
  std::exception_ptr failed, raised;
  ++at_work;
  std::thread worker([&] {
    try {
      result.emplace(work(on_progress));
    } catch (...) {
      failed = std::current_exception();
    }
    finished = true;
  });
  bool by_signal = false;
  while (!finished) {
    {
      const py::gil_scoped_release released;
      std::this_thread::sleep_for(std::chrono::milliseconds(done == 0 ? 2 : 20));
    }
    if (by_signal) psf::interrupt();  // another call may have cleared it
    if (raised) continue;
    try {
      by_signal = PyErr_CheckSignals() != 0;
      if (by_signal) throw py::error_already_set();
      if (!progress.is_none() && total > 0) progress(done.load(), total.load());
    } catch (...) {
      raised = std::current_exception();
      stopped = true;
    }
  }
  worker.join();
  --at_work;
  if (by_signal) psf::clear_interrupt();
  if (raised) std::rethrow_exception(raised);
  if (failed) std::rethrow_exception(failed);
  if (!progress.is_none() && total > 0) progress(total.load(), total.load());
  return std::move(*result);
}

// Threads that Python does not wait for end here, before the interpreter does.
void end_all() {
  const py::gil_scoped_release released;
  while (at_work > 0) {
    psf::interrupt();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

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

py::dtype dtype_of(const psf::Channel& channel) {
  return py::dtype((channel.type[0] == 'f' ? "<f" : "<u") +
                   std::to_string(std::stoi(channel.type.substr(1)) / 8));
}

// Records [first, first + count) of a channel: (count) or (count, components).
py::array read_channel(const psf::Dump& dump, const psf::Channel& channel, std::uint64_t first,
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

psf::FilterOptions options_of(std::uint64_t first, std::optional<std::uint64_t> last,
                              std::optional<std::uint64_t> max_memory) {
  psf::FilterOptions options;
  options.passes = {first, last};
  options.max_memory = max_memory;
  return options;
}

// A psf.Error with the attribute `code`; ^C is KeyboardInterrupt. Backquotes of parameters go.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const psf::Error& error) {
    if (error.code() == psf::ErrorCode::interrupted) {
      PyErr_SetString(PyExc_KeyboardInterrupt, error.what());
      return;
    }
    std::string text = error.what();
    std::erase(text, '`');
    const py::object type = py::module_::import("psf._psf").attr("Error");
    const py::object value = type(text);
    value.attr("code") = static_cast<int>(error.code());
    PyErr_SetObject(type.ptr(), value.ptr());
  }
}

}  // namespace

PYBIND11_MODULE(_psf, m) {
  m.attr("version") = PSF_VERSION;
  static const py::exception<psf::Error> kError(m, "Error");
  py::register_exception_translator(translate);
  py::module_::import("atexit").attr("register")(py::cpp_function(end_all));

  m.def("parameters", [] {
    std::vector<std::tuple<std::string, std::string, std::string, std::string>> all;
    for (const psf::ParameterHelp& one : psf::Parameters::help()) {
      all.emplace_back(one.name, one.type, one.help, one.standard);
    }
    return all;
  });
  m.def("metric_names", psf::metric_names);

  py::class_<psf::Channel>(m, "Channel")
      .def_readonly("name", &psf::Channel::name)
      .def_readonly("type", &psf::Channel::type)
      .def_readonly("components", &psf::Channel::components)
      .def_readonly("octahedral", &psf::Channel::octahedral)
      .def_property_readonly("dtype", dtype_of);

  py::class_<psf::Camera>(m, "Camera")
      .def(py::init([](std::string name, std::uint32_t width, std::uint32_t height, double angle) {
             return psf::Camera{std::move(name), width, height, angle};
           }),
           py::arg("name"), py::arg("width"), py::arg("height"), py::arg("angle_per_pixel") = 0.0)
      .def_readonly("name", &psf::Camera::name)
      .def_readonly("width", &psf::Camera::width)
      .def_readonly("height", &psf::Camera::height)
      .def_readonly("angle_per_pixel", &psf::Camera::angle_per_pixel);

  py::class_<psf::Picture>(m, "Picture")
      .def_readonly("width", &psf::Picture::width)
      .def_readonly("height", &psf::Picture::height)
      .def_readonly("camera", &psf::Picture::camera)
      .def_property_readonly("attributes",
                             [](const psf::Picture& picture) {
                               py::dict all;
                               for (const auto& [name, text] : picture.attributes) {
                                 all[py::str(name)] = text;
                               }
                               return all;
                             })
      .def_property_readonly("layer_names",
                             [](const psf::Picture& picture) {
                               std::vector<std::string> names;
                               for (const psf::Layer& layer : picture.layers) {
                                 names.push_back(layer.name);
                               }
                               return names;
                             })
      // A view of the picture's own memory.
      .def("layer",
           [](const py::object& self, const std::string& name) {
             const auto& picture = self.cast<const psf::Picture&>();
             const std::vector<float>& values = picture.layer(name);
             return py::array_t<float>({static_cast<py::ssize_t>(picture.height),
                                        static_cast<py::ssize_t>(picture.width)},
                                       values.data(), self);
           })
      .def(
          "rgb",
          [](const psf::Picture& picture, const std::string& prefix) {
            return adopt(picture.rgb(prefix), {static_cast<py::ssize_t>(picture.height),
                                               static_cast<py::ssize_t>(picture.width), 3});
          },
          py::arg("prefix") = "")
      .def("png",
           [](const psf::Picture& picture, float exposure) {
             const std::vector<unsigned char> file = picture.png(exposure);
             return py::bytes(reinterpret_cast<const char*>(file.data()), file.size());
           })
      .def("save", &psf::Picture::save, py::call_guard<py::gil_scoped_release>())
      .def_static("read", &psf::Picture::read, py::arg("path"), py::arg("layer") = "",
                  py::call_guard<py::gil_scoped_release>())
      .def("error", &psf::Picture::error, py::call_guard<py::gil_scoped_release>());

  py::class_<psf::FilterResult>(m, "FilterResult")
      .def("take_pictures", [](psf::FilterResult& result) { return std::move(result.pictures); })
      .def_readonly("notes", &psf::FilterResult::notes)
      .def_readonly("passes", &psf::FilterResult::passes)
      .def_readonly("blocks", &psf::FilterResult::blocks)
      .def_readonly("sources", &psf::FilterResult::sources)
      .def_readonly("queries", &psf::FilterResult::queries)
      .def_readonly("orphans", &psf::FilterResult::orphans)
      .def_readonly("left_out", &psf::FilterResult::left_out)
      .def_readonly("neighbors", &psf::FilterResult::neighbors);

  py::class_<psf::Dump>(m, "Dump")
      .def(py::init<const std::string&>(), py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("path", &psf::Dump::path)
      .def_property_readonly("records", &psf::Dump::records)
      .def_property_readonly("passes", &psf::Dump::passes)
      .def_property_readonly("closed", &psf::Dump::closed)
      .def_property_readonly("metadata", &psf::Dump::metadata)
      .def_property_readonly("channels", &psf::Dump::channels)
      .def_property_readonly("cameras", &psf::Dump::cameras)
      .def("refresh", &psf::Dump::refresh)
      .def("read", read_channel)
      .def("filter",
           [](const psf::Dump& dump, const Texts& given, bool no_weights, std::uint64_t first,
              std::optional<std::uint64_t> last, std::optional<std::uint64_t> max_memory,
              const py::object& progress) {
             const psf::Parameters parameters = parameters_of(given, no_weights);
             return interruptible(progress, [&](const auto& on_progress) {
               psf::FilterOptions options = options_of(first, last, max_memory);
               options.on_progress = on_progress;
               return dump.filter(parameters, options);
             });
           })
      .def("sweep",
           [](const psf::Dump& dump, const psf::Picture& reference, const std::vector<Texts>& sets,
              bool no_weights, const std::vector<std::string>& metrics, std::uint64_t first,
              std::optional<std::uint64_t> last, std::optional<std::uint64_t> max_memory,
              std::size_t camera, const py::object& progress) {
             std::vector<psf::Parameters> parameters;
             for (const Texts& set : sets) parameters.push_back(parameters_of(set, no_weights));
             const std::vector<psf::SweepRow> rows =
                 interruptible(progress, [&](const auto& on_progress) {
                   psf::FilterOptions options = options_of(first, last, max_memory);
                   options.on_progress = on_progress;
                   return dump.sweep(reference, parameters, metrics, options, camera);
                 });
             py::list result;
             for (const psf::SweepRow& row : rows) {
               py::dict values;
               for (const auto& [name, text] : row.parameters) values[py::str(name)] = text;
               for (const auto& [name, error] : row.errors) values[py::str(name)] = error;
               values["neighbors"] = row.neighbors;
               values["seconds"] = row.seconds;
               result.append(values);
             }
             return result;
           });

  m.def("filter_records",
        [](const std::vector<psf::Camera>& cameras, const Texts& given, bool no_weights, double n,
           const Column<float>& position, const Column<float>& throughput,
           const Column<float>& contribution, const Column<std::uint32_t>& pixel,
           const Column<float>& distance, const Column<float>& unfiltered,
           const Column<float>& normal, const Column<float>& reflectance,
           const Column<float>& direction, const Column<float>& hit_distance,
           const Column<float>& roughness, const Column<std::uint32_t>& visibility,
           const Column<std::uint32_t>& material, const Column<std::uint16_t>& camera,
           const Column<std::uint8_t>& flags) {
          const psf::Parameters parameters = parameters_of(given, no_weights);
          psf::Records records;
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
          psf::FilteredRecords done = interruptible(py::none(), [&](const auto&) {
            return psf::filter_records(records, cameras, parameters, n);
          });
          const auto count = static_cast<py::ssize_t>(done.neighbors.size());
          return py::make_tuple(adopt(std::move(done.c_bar), {count, 3}),
                                adopt(std::move(done.neighbors), {count}),
                                adopt(std::move(done.radius), {count}), std::move(done.pictures));
        });

  py::class_<psf::DumpWriter>(m, "DumpWriter")
      .def(py::init(
          [](const std::string& path, const std::vector<psf::Camera>& cameras,
             const std::vector<std::tuple<std::string, std::string, std::size_t, bool>>& channels,
             bool compress, const std::string& metadata) {
            std::vector<psf::Channel> all;
            for (const auto& [name, type, components, octahedral] : channels) {
              all.push_back({name, type, components, octahedral});
            }
            return psf::DumpWriter(path, cameras, all, {compress, metadata});
          }))
      .def_property_readonly("channels", &psf::DumpWriter::channels)
      .def_property_readonly("records", &psf::DumpWriter::records)
      .def_property_readonly("passes", &psf::DumpWriter::passes)
      // Arrays of the channels' types, contiguous, of `count` rows: __init__.py sees to it.
      .def("append",
           [](psf::DumpWriter& writer, std::size_t count, const std::vector<py::array>& arrays) {
             std::vector<const void*> columns;
             for (const py::array& array : arrays) columns.push_back(array.data());
             const py::gil_scoped_release released;
             writer.append(count, columns);
           })
      .def("commit_pass", &psf::DumpWriter::commit_pass, py::call_guard<py::gil_scoped_release>())
      .def("close", &psf::DumpWriter::close, py::call_guard<py::gil_scoped_release>());
}
