// psf-bench sweep: 64 pairs of r0 and delta in one traversal against one run at the largest radius.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/benches.h"
#include "bench/rows.h"
#include "bench/turns.h"
#include "cli.h"
#include "core/json_text.h"
#include "core/parallel.h"
#include "filter/parameters/text.h"
#include "option_values.h"
#include "run/filter_dump.h"
#include "run/many_dump.h"
#include "version.h"

namespace psf::bench {
namespace {

struct SweepOptions {
  tools::CommonOptions common;
  std::string input;
  std::vector<std::string> largest = {"4px", "8px", "16px"};
  std::size_t repeat = 3;
  bool check = false;
};

constexpr Target kAtMost5{Target::Kind::at_most, 5};
constexpr Target kSame{Target::Kind::at_most, 1e-5};
constexpr int kSteps = 8;  // number of values of r0, by factors of sqrt(2), and of delta, by 0.1

std::vector<filter::Radius> pairs(const filter::Radius& largest) {
  std::vector<filter::Radius> radii;
  for (int a = 0; a < kSteps; ++a) {
    for (int b = 0; b < kSteps; ++b) {
      filter::Radius radius = largest;
      radius.r0 *= std::pow(2.0, -0.5 * a);
      radius.delta = 0.1 + 0.1 * b;
      radii.push_back(radius);
    }
  }
  return radii;
}

double largest_difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double scale = std::max(1e-6, std::abs(double{b[i][c]}));
      largest = std::max(largest, std::abs(double{a[i][c]} - double{b[i][c]}) / scale);
    }
  }
  return largest;
}

void add_rows(const run::Dump& dump, const std::string& r0, std::size_t repeat,
              std::vector<Row>& rows) {
  filter::Parameters parameters;
  filter::set_parameter(parameters, "r0", r0);
  run::ManyRequest many;
  many.radii = pairs(parameters.radius);
  run::FilterRequest one;
  one.parameters.radius = many.radii.front();
  const auto filter_many = [&] { return run::filter_many(dump, many); };
  const auto filter_one = [&] { return run::filter_dump(dump, one); };
  const run::FilterResult alone = filter_one();
  const double difference =
      largest_difference(filter_many().pictures[0].filtered(0), alone.pictures[0].image().rgb());
  const Turns turns(
      repeat, [&] { return seconds_of(filter_many); }, [&] { return seconds_of(filter_one); });
  rows.push_back({"pairs_" + r0,
                  fmt::format("64 pairs up to {} / one run, {:.0f} neighbours", r0,
                              alone.statistics.mean_neighbors()),
                  "x", turns.ratio(), kAtMost5, turns.detail()});
  rows.push_back({"difference_" + r0, fmt::format("largest difference of a pixel, {}", r0), "",
                  spread({difference}), kSame, "relative, of the largest radius"});
}

void run(const SweepOptions& options) {
  tools::keep_freed_memory();
  const core::ThreadLimit threads(options.common.threads);
  tools::check_files({options.input}, {options.common.json});
  const run::Dump dump(options.input);
  std::vector<Row> rows;
  for (const std::string& r0 : options.largest) add_rows(dump, r0, options.repeat, rows);
  print_table(rows);
  if (!options.common.json.empty()) {
    const nlohmann::ordered_json json = {{"version", tools::kVersion},
                                         {"dump", options.input},
                                         {"repeat", options.repeat},
                                         {"rows", to_json(rows)}};
    core::write_json_file(options.common.json, json);
  }
  if (options.check) require_targets(rows);
}

}  // namespace

void add_sweep(CLI::App& app) {
  auto options = std::make_shared<SweepOptions>();
  CLI::App* command = app.add_subcommand(
      "sweep", "measure 64 pairs of r0 and delta against one run at the largest radius");
  command->add_option("IN", options->input, "path-vertex buffer")
      ->required()
      ->type_name("FILE.pvb");
  command->add_option("--r0", options->largest, "largest radii (default 4px,8px,16px)")
      ->delimiter(',')
      ->type_name("R,...");
  tools::add_number<std::size_t>(*command, "--repeat", options->repeat, 1, 1000,
                                 "runs of each, in turn");
  command->add_flag("--check", options->check, "exit code 1 where a target is missed");
  tools::add_common(*command, options->common);
  tools::set_example(*command, "psf-bench sweep cornell.pvb");
  command->callback([options] { run(*options); });
}

}  // namespace psf::bench
