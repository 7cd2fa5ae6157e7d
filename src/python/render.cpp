// The Python module psf._render: psf-render's work. A module of its own, because it needs Embree.
#include <pybind11/stl.h>

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/interrupt.h"
#include "interruptible.h"
#include "psf/version.h"
#include "render/job/options.h"

namespace psf::python {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

// Figures as psf-render --json writes them, and notes.
std::tuple<std::string, std::vector<std::string>> render_files(
    const std::string& scene, const std::string& output, const std::vector<std::string>& images,
    bool resume, const Settings& settings, const py::object& progress) {
  render::Job job;
  job.scene = scene;
  job.output = output;
  job.images = images;
  job.resume = resume;
  job.version = PSF_VERSION;
  job.settings.quiet = true;
  for (const auto& [name, text] : settings) render::set_option(job, name, text);
  std::vector<std::string> notes;
  job.on_note = [&notes](const std::string& note) { notes.push_back(note); };
  const std::string figures =
      interruptible<core::Interruptible>(progress, [&](const auto& on_progress) {
        job.settings.on_progress = on_progress;
        const render::JobResult result = render::run_job(job);
        render::throw_if_stopped(job, result);
        return render::figures(job, result);
      });
  return {figures, notes};
}

}  // namespace

PYBIND11_MODULE(_render, m) {
  py::register_exception_translator(translate);
  end_at_exit(core::interrupt);
  m.def("render", render_files);
  m.def("options", [] {
    std::vector<std::tuple<std::string, std::string, std::string, std::string>> all;
    for (const render::Option& one : render::option_table()) {
      all.emplace_back(one.name, one.type, one.help, one.standard);
    }
    return all;
  });
}

}  // namespace psf::python
