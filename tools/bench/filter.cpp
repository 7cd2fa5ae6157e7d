// psf-bench filter: the targets that concern the filter, and how its cost grows.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/benches.h"
#include "bench/filter_rows.h"
#include "bench/floor_rows.h"
#include "bench/growth.h"
#include "cli.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "filter/parameters/text.h"
#include "version.h"

namespace psf::bench {
namespace {

struct FilterOptions {
  tools::CommonOptions common;
  std::string input;  // empty: made up
  std::size_t records = std::size_t{1} << 18;
  std::vector<std::size_t> neighbors = {35, 400, 3000, 10000};
  std::size_t repeat = 5;
  bool growth = false;
  std::size_t growth_records = std::size_t{1} << 24;
  bool check = false;
};

// One run of the command: what it measures on, and what it found.
class Bench {
 public:
  explicit Bench(const FilterOptions& options)
      : options_(options),
        dump_(open(options.input)),
        progress_("bench", options.common.quiet),
        sample_(make_sample(options.records)) {}

  void measure() {
    measure_speed();
    if (reach_.radius.empty()) {
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: no radius gives any of the --neighbors; take more --records or "
                              "fewer neighbours",
                              input()));
    }
    add(agreement_rows(agreement_));
    measure_threads();
    measure_floor();
    if (sample_.passes.size() > 2) add({passes_row(sample_, reach_, options_.repeat)});
    step();
    if (options_.growth) measure_growth();
    progress_.finish();
  }

  void print() const {
    fmt::print("{} records, {}; {} runs at most, each builds its index\n\n", sample_.size(),
               input(), options_.repeat);
    print_table(rows_);
    if (!growth_.empty()) fmt::print("\n");
    if (!growth_.empty()) print_growth(growth_);
    if (!skipped_.empty()) fmt::print("\n");
    for (const std::string& text : skipped_) fmt::print("left out: {}\n", text);
  }

  [[nodiscard]] nlohmann::ordered_json json() const {
    std::vector<Point> points = points_;
    points.insert(points.end(), growth_.begin(), growth_.end());
    return {{"benchmark", "filter"},
            {"version", tools::kVersion},
            {"input", input()},
            {"records", sample_.size()},
            {"threads", core::thread_count()},
            {"repeat", options_.repeat},
            {"parameters", parameters()},
            {"rows", bench::to_json(rows_)},
            {"points", bench::to_json(points)},
            {"left_out", skipped_}};
  }

  // Other neighbours are an error, whether targets are asked for or not.
  void check() const {
    if (agreement_.differing > 0) {
      throw Error(ErrorCode::comparison,
                  fmt::format("{} records have other neighbours than plain FLANN finds",
                              agreement_.differing));
    }
    if (options_.check) require_targets(rows_);
  }

 private:
  static std::optional<run::Dump> open(const std::string& path) {
    return path.empty() ? std::nullopt : std::optional<run::Dump>(path);
  }

  [[nodiscard]] std::string input() const {
    return options_.input.empty() ? "made up" : options_.input;
  }

  // Without r0, which every point has its own of, and the engine.
  [[nodiscard]] nlohmann::ordered_json parameters() const {
    nlohmann::ordered_json out;
    for (const auto& [name, value] : filter::describe(sample_.parameters)) out[name] = value;
    out.erase("r0");
    out.erase("search");
    out["block"] = "all";
    const auto basis = sample_.parameters.radius.basis;
    out["r0_unit"] = basis == filter::RadiusBasis::footprint ? "px" : "distance";
    return out;
  }

  [[nodiscard]] Sample make_sample(std::size_t records) const {
    return dump_ ? read_sample(*dump_, records) : make_box(records);
  }

  [[nodiscard]] std::vector<std::size_t> growth_sizes() const {
    std::vector<std::size_t> sizes;
    for (std::size_t size = kFirstRecords; size <= options_.growth_records; size *= 4) {
      if (!dump_ || size <= dump_->reader().records()) sizes.push_back(size);
    }
    return sizes;
  }

  [[nodiscard]] std::size_t steps() const {
    const std::size_t growth = std::size(kGrowthNeighbors) + growth_sizes().size();
    return options_.neighbors.size() + 3 + (options_.growth ? growth : 0);
  }

  void step() {
    progress_.advance(++done_, steps());
    core::throw_if_interrupted("nothing is written");
  }

  void add(std::vector<Row> more) { rows_.insert(rows_.end(), more.begin(), more.end()); }

  void leave_out(std::size_t neighbors, std::size_t records) {
    const std::string text =
        fmt::format("{} neighbours: no radius gives so many in {} records, as the weights are",
                    neighbors, records);
    if (std::find(skipped_.begin(), skipped_.end(), text) == skipped_.end()) {
      skipped_.push_back(text);
    }
  }

  void measure_speed() {
    for (const std::size_t wanted : options_.neighbors) {
      const auto reach = find_reach(sample_, static_cast<double>(wanted));
      if (reach) {
        add({speed_row(sample_, *reach, wanted, options_.repeat, agreement_, points_)});
        if (reach_.radius.empty() || wanted == kThreadsNeighbors) reach_ = *reach;
      } else {
        leave_out(wanted, sample_.size());
      }
      step();
    }
  }

  void measure_threads() {
    const std::size_t all = core::thread_count();
    if (all >= 2) add({threads_row(sample_, reach_, 2, options_.repeat)});
    if (all > 2) add({threads_row(sample_, reach_, all, options_.repeat)});
    step();
  }

  void measure_floor() {
    add(floor_rows(sample_, options_.repeat));
    add({floor_share_row(sample_, reach_, options_.repeat)});
    add(instruction_set_rows(sample_, reach_, options_.repeat));
    step();
  }

  void add_growth(const Sample& sample, const char* series, std::size_t neighbors) {
    const bool more = !growth_.empty() && growth_.back().series == series;
    const double start = more ? growth_.back().reach.r0 : 0;
    if (const auto point = growth_point(sample, series, neighbors, start, options_.repeat)) {
      growth_.push_back(*point);
    } else {
      leave_out(neighbors, sample.size());
    }
    step();
  }

  void measure_growth() {
    for (const std::size_t neighbors : kGrowthNeighbors) {
      add_growth(sample_, "neighbors", neighbors);
    }
    for (const std::size_t records : growth_sizes()) {
      add_growth(make_sample(records), "records", kFixedNeighbors);
    }
  }

  static constexpr std::size_t kThreadsNeighbors = 400;  // where asked for, else the first

  const FilterOptions& options_;
  std::optional<run::Dump> dump_;
  core::Progress progress_;
  Sample sample_;
  std::size_t done_ = 0;
  Reach reach_;  // for threads, the floor, instruction sets and passes
  Agreement agreement_;
  std::vector<Row> rows_;
  std::vector<Point> points_, growth_;
  std::vector<std::string> skipped_;
};

void run(const FilterOptions& options) {
  tools::keep_freed_memory();
  const core::ThreadLimit threads(options.common.threads);
  tools::check_files({options.input}, {options.common.json});
  Bench bench(options);
  bench.measure();
  bench.print();
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, bench.json());
  }
  bench.check();
}

}  // namespace

void add_filter(CLI::App& app) {
  auto options = std::make_shared<FilterOptions>();
  CLI::App* command = app.add_subcommand(
      "filter", "measure the filter against plain FLANN on the same records, by neighbours");
  command
      ->add_option("IN", options->input, "path-vertex buffer to filter; a made-up box unless given")
      ->type_name("FILE.pvb");
  command->add_option("--records", options->records, "in the block, of a file at most")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 26))
      ->capture_default_str();
  command
      ->add_option("--neighbors", options->neighbors,
                   "averaged a record, in the mean; a row each, at the radius that gives them")
      ->check(CLI::Range(2, 1000000))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  command
      ->add_option("--repeat", options->repeat,
                   "measurements, fewer of what takes minutes; the table has their medians")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--growth", options->growth,
                    "also measure 10 to 10,000 neighbours, and 2^14 records and more");
  command
      ->add_option("--growth-records", options->growth_records, "so many at most; 2^24 need 4 GB")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 26))
      ->capture_default_str();
  command->add_flag("--check", options->check, "exit with 1 where a target is missed");
  tools::add_common(*command, options->common);
  tools::set_example(*command, "psf-bench filter cornell.pvb --neighbors 35,400 --json bench.json");
  command->callback([options] { run(*options); });
}

}  // namespace psf::bench
