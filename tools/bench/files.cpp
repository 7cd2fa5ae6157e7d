// psf-bench files: the targets that concern path-vertex buffers.
#include <fmt/format.h>
#include <stdlib.h>  // NOLINT: mkdtemp is POSIX

#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/benches.h"
#include "bench/dumps.h"
#include "bench/read_rows.h"
#include "bench/write_rows.h"
#include "cli.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/parallel.h"
#include "core/unfinished.h"
#include "version.h"

namespace psf::bench {
namespace {

struct FilesOptions {
  tools::CommonOptions common;
  std::string input;  // empty: made up
  std::size_t records = std::size_t{1} << 21;
  std::size_t repeat = 7;
  std::string temp = std::filesystem::temp_directory_path();
  RenderRun render;  // where a scene is given
  bool check = false;
};

// Removed with all that is in it.
class TempFolder {
 public:
  explicit TempFolder(const std::string& parent) {
    std::string name = std::filesystem::path(parent) / "psf-bench-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) {
      throw Error(ErrorCode::io, parent + ": cannot create a folder in it; give another to --temp");
    }
    path_ = name;
    unfinished_.emplace_back(name);
    for (const char* of_render : {"render.json", "render.pvb", "render.exr"}) {
      unfinished_.emplace_back(name + "/" + of_render);
    }
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] std::string operator/(const char* name) {
    unfinished_.emplace_back((path_ / name).string());
    return path_ / name;
  }
  [[nodiscard]] std::string path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::deque<core::Unfinished> unfinished_;  // the folder and what is in it
};

void add(std::vector<Row>& rows, std::vector<Row> more) {
  rows.insert(rows.end(), more.begin(), more.end());
  core::throw_if_interrupted("nothing is written");
}

void make_dumps(const FilesOptions& options, const std::string& raw, const std::string& zstd) {
  if (options.input.empty()) {
    write_synthetic(raw, options.records, formats::Codec::raw);
    write_synthetic(zstd, options.records, formats::Codec::zstd);
    return;
  }
  const formats::Reader reader(options.input);
  write_copy(reader, raw, options.records, formats::Codec::raw);
  write_copy(reader, zstd, options.records, formats::Codec::zstd);
}

nlohmann::ordered_json to_json(const FilesOptions& options, const formats::Reader& dump,
                               const std::vector<Row>& rows) {
  return {{"benchmark", "files"},
          {"version", tools::kVersion},
          {"input", options.input.empty() ? "made up" : options.input},
          {"records", dump.records()},
          {"bytes_a_record", dump.head().stride()},
          {"threads", core::thread_count()},
          {"repeat", options.repeat},
          {"page_cache", "warm"},
          {"rows", bench::to_json(rows)}};
}

void run(const FilesOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  tools::check_files({options.input, options.render.scene}, {options.common.json});
  TempFolder folder(options.temp);
  const std::string raw = folder / "raw.pvb", zstd = folder / "zstd.pvb";
  make_dumps(options, raw, zstd);
  std::vector<Row> rows;
  add(rows, read_rows(raw, zstd, options.repeat));
  add(rows, size_rows(raw, zstd, !options.input.empty()));
  add(rows, {open_row(folder / "sparse.pvb", options.repeat)});
  if (!options.render.scene.empty()) {
    RenderRun render = options.render;
    render.threads = options.common.threads;
    render.folder = folder.path();
    add(rows, render_rows(render, options.repeat));
  }
  const formats::Reader dump(raw);
  fmt::print("{} records of {} bytes{}, {} times, {} thread{}, files in the page cache\n\n",
             dump.records(), dump.head().stride(),
             options.input.empty() ? ", made up" : " of " + options.input, options.repeat,
             core::thread_count(), core::thread_count() == 1 ? "" : "s");
  print_table(rows);
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, to_json(options, dump, rows));
  }
  if (options.check) require_targets(rows);
}

}  // namespace

void add_files(CLI::App& app) {
  auto options = std::make_shared<FilesOptions>();
  CLI::App* command = app.add_subcommand(
      "files", "measure reading, writing and opening path-vertex buffers, files in the page cache");
  command
      ->add_option("IN", options->input,
                   "path-vertex buffer to copy and measure; made-up records unless given")
      ->type_name("FILE.pvb");
  command->add_option("--records", options->records, "about so many records at most")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 32))
      ->capture_default_str();
  command->add_option("--repeat", options->repeat, "measurements; the table has their medians")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--scene", options->render.scene,
                   "also render this scene with and without a dump")
      ->type_name("FILE");
  command
      ->add_option("--render-options", options->render.options,
                   "more for psf-render, \"--sky 1,1,1 --size 512x512\"")
      ->type_name("TEXT");
  command->add_option("--passes", options->render.passes, "of each render")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  command->add_option("--temp", options->temp, "folder for the files that are measured")
      ->type_name("FOLDER")
      ->capture_default_str();
  command->add_flag("--check", options->check, "exit with 1 where a target is missed");
  tools::add_common(*command, options->common);
  tools::set_example(*command, "psf-bench files cornell.pvb --scene sample_data/cornell.json");
  command->callback([options] { run(*options); });
}

}  // namespace psf::bench
