#include "bench/write_rows.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "core/error.h"
#include "formats/read/reader.h"
#include "formats/read/statistics.h"

namespace psf::bench {
namespace {

struct Bytes {
  double raw = 0, stored = 0, file = 0;
};

Bytes bytes_of(const std::string& path) {
  const formats::Reader reader(path);
  Bytes bytes;
  bytes.file = static_cast<double>(reader.file_bytes());
  for (const formats::ChannelSize& size : formats::channel_sizes(reader.table(0))) {
    bytes.raw += static_cast<double>(size.raw);
    bytes.stored += static_cast<double>(size.stored);
  }
  return bytes;
}

Row once(std::string name, std::string what, double value, std::optional<Target> target,
         std::string detail) {
  return {std::move(name), std::move(what), "%", {value, value, value}, target, std::move(detail)};
}

// Waits for it and returns the processor time that it took, in seconds; its output is not wanted,
// its errors are.
double run_program(const std::string& program, std::vector<std::string> arguments) {
  std::vector<char*> argv;
  arguments.insert(arguments.begin(), program);
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = posix_spawn(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw Error(ErrorCode::io, fmt::format("{}: cannot run: {}; psf-bench runs the psf-render "
                                           "beside it",
                                           program, std::strerror(error)));
  }
  int status = 0;
  rusage used{};
  while (::wait4(child, &status, 0, &used) < 0) {
    if (errno != EINTR) throw Error(ErrorCode::io, program + ": lost");
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw Error(ErrorCode::bad_input, program + ": failed; what it said stands above");
  }
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

struct Render {
  double seconds = 0, output_seconds = 0;  // real time of the loop over passes
  double processor = 0;                    // seconds of the whole program
};

Render render(const RenderRun& run, bool dump) {
  const std::filesystem::path folder = run.folder;
  const std::string figures = folder / "render.json", file = folder / "render.pvb";
  const std::string program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "psf-render";
  std::vector<std::string> arguments = {run.scene,   "--quiet",
                                        "--passes",  std::to_string(run.passes),
                                        "--threads", std::to_string(run.threads),
                                        "--json",    figures,
                                        "--image",   folder / "render.exr"};
  if (dump) arguments.insert(arguments.end(), {"-o", file});
  std::istringstream words(run.options);
  arguments.insert(arguments.end(), std::istream_iterator<std::string>(words), {});
  std::filesystem::remove(file);
  const double processor = run_program(program, arguments);
  const auto json = nlohmann::json::parse(std::ifstream(figures));
  return {json.at("seconds").get<double>(), json.at("output_seconds").get<double>(), processor};
}

}  // namespace

std::vector<Row> size_rows(const std::string& raw, const std::string& zstd, bool is_real) {
  const Bytes plain = bytes_of(raw), packed = bytes_of(zstd);
  const double overhead = plain.file / plain.raw - 1, stored = packed.stored / packed.raw;
  std::optional<Target> size;
  if (is_real) size = Target{Target::Kind::at_most, 0.55};
  return {once("raw_overhead", "raw file: bytes that are no values / values", overhead,
               Target{Target::Kind::at_most, 0.002}, fmt::format("{:.1f} MB", plain.file / 1e6)),
          once("zstd_size", "zstd columns: stored / raw", stored, size,
               is_real ? fmt::format("{:.1f} of {:.1f} MB", packed.stored / 1e6, packed.raw / 1e6)
                       : "made-up values: for information")};
}

std::vector<Row> render_rows(const RenderRun& run, std::size_t repeat) {
  std::vector<double> clock, processor, waiting, alone;
  static_cast<void>(render(run, false));  // the scene's files into the page cache
  for (std::size_t k = 0; k < repeat; ++k) {
    const Render without = render(run, false), with = render(run, true);
    clock.push_back(with.seconds / without.seconds - 1);
    processor.push_back(with.processor / without.processor - 1);
    waiting.push_back(with.output_seconds / (with.seconds - with.output_seconds));
    alone.push_back(without.seconds);
  }
  const std::string detail = fmt::format("{} passes, {:.2f} s", run.passes, spread(alone).median);
  const Target target{Target::Kind::at_most, 0.05};
  return {{"write_clock", "render with a dump / without, less 1: by the clock", "%", spread(clock),
           target, detail},
          {"write_processor", "render with a dump / without, less 1: processor time", "%",
           spread(processor), target, detail},
          {"write_waiting", "render that waits for the writer / rest of it", "%", spread(waiting),
           target, detail}};
}

}  // namespace psf::bench
