// Long work without the interpreter lock, for both compiled modules.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "psf/error.h"

namespace psf::python {

namespace py = pybind11;

// Calls of this module that are at work.
inline std::atomic<int> at_work{0};
// The thread that ends the interpreter, once it does. Calls of others may not begin: who waits for
// the interpreter then is ended in the midst. Read and written with the interpreter lock.
inline std::optional<std::thread::id> ending;
[[nodiscard]] inline bool is_cut_off() {
  return ending && *ending != std::this_thread::get_id();
}

// Counts a call from here to the end of the scope.
struct AtWork {
  AtWork() { ++at_work; }
  ~AtWork() { --at_work; }
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;
};

// Ends the thread that makes a call, without a word.
[[noreturn]] inline void end_thread() {
  PyErr_SetNone(PyExc_SystemExit);
  throw py::error_already_set();
}

// Does work(on_progress) on a thread of its own: meanwhile this one looks for ^C and hands on
// progress. What Python raises ends this call and no other. `Scope`: Interruptible of the library
// or of core.
template <class Scope, class Work>
auto interruptible(const py::object& progress, const Work& work) {
  if (is_cut_off()) end_thread();
  std::atomic<std::uint64_t> done{0}, total{0};
  std::atomic<bool> stopped{false}, finished{false};
  const auto on_progress = [&](std::uint64_t now, std::uint64_t all) {
    total = all;
    done = now;
  };
  std::optional<decltype(work(on_progress))> result;
  std::exception_ptr failed, raised;
  std::thread worker([&] {
    try {
      const Scope scope(stopped);
      result.emplace(work(on_progress));
    } catch (...) {
      failed = std::current_exception();
    }
    finished = true;
  });
  const AtWork counted;  // not before: the thread may not have started
  while (!finished) {
    {
      const py::gil_scoped_release released;
      std::this_thread::sleep_for(std::chrono::milliseconds(done == 0 ? 2 : 20));
    }
    if (raised) continue;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!progress.is_none() && total > 0) progress(done.load(), total.load());
    } catch (...) {
      raised = std::current_exception();
      stopped = true;
    }
  }
  worker.join();
  if (is_cut_off()) end_thread();
  if (raised) std::rethrow_exception(raised);
  if (failed) std::rethrow_exception(failed);
  if (!progress.is_none() && total > 0) progress(done.load(), total.load());
  return std::move(*result);
}

// Threads that Python does not wait for end their calls before the interpreter ends: interrupt()
// ends all calls.
inline void end_at_exit(void (*interrupt)() noexcept) {
  py::module_::import("atexit").attr("register")(py::cpp_function([interrupt] {
    ending = std::this_thread::get_id();
    const py::gil_scoped_release released;
    while (at_work > 0) {
      interrupt();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }));
}

// A psf.Error with the attribute `code`; ^C is KeyboardInterrupt. Backquotes of parameters go.
// NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11 asks for a value.
inline void translate(std::exception_ptr thrown) {
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

}  // namespace psf::python
