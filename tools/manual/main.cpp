// psf-manual FOLDER: man pages and shell completions of the programs, made from their own options.
// Runs while psf is built; it is not installed.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>

#include "bench/benches.h"
#include "core/error.h"
#include "manual/writers.h"
#include "psf/verbs.h"
#ifdef PSF_WITH_RENDER
#include "psf-render/options.h"
#endif

namespace psf::manual {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw Error(ErrorCode::io, path.string() + ": cannot be written");
}

void write_all(const fs::path& folder, const std::vector<Command>& programs,
               const Command& program) {
  const auto write_page = [&](const Command& command) {
    write(folder / "man1" / (page_name(program, command) + ".1"),
          man_page(programs, program, command));
  };
  write_page(program);
  for (const Command& verb : program.verbs) write_page(verb);
  write(folder / "bash" / program.name, bash_completion(program));
  write(folder / "zsh" / ("_" + program.name), zsh_completion(program));
  write(folder / "fish" / (program.name + ".fish"), fish_completion(program));
}

std::vector<Command> describe_all() {
  std::vector<Command> programs;
  CLI::App psf, bench;
  tools::declare_psf(psf);
  programs.push_back(describe(psf));
#ifdef PSF_WITH_RENDER
  CLI::App render;
  tools::RenderOptions options;
  tools::declare_psf_render(render, options);
  programs.push_back(describe(render));
#endif
  bench::declare_psf_bench(bench);
  programs.push_back(describe(bench));
  return programs;
}

void write_all(const fs::path& folder) {
  const std::vector<Command> programs = describe_all();
  fs::remove_all(folder);  // a verb that is no more has no page
  for (const Command& program : programs) write_all(folder, programs, program);
}

}  // namespace
}  // namespace psf::manual

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw psf::Error(psf::ErrorCode::usage, "usage: psf-manual FOLDER");
    psf::manual::write_all(argv[1]);
    return 0;
  } catch (const psf::Error& error) {
    std::fprintf(stderr, "psf-manual: %s\n", error.what());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "psf-manual: %s\n", error.what());
    return static_cast<int>(psf::ErrorCode::io);
  }
}
