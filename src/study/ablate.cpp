#include "study/ablate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/seconds.h"
#include "core/text.h"
#include "film/image.h"
#include "filter/parameters/text.h"
#include "run/filter_dump.h"
#include "run/memory.h"

namespace psf::study {
namespace {

// "normal 0.95", "visibility".
std::string term_text(filter::Term term, const filter::Parameters& parameters) {
  const filter::Parameter& parameter = filter::find_parameter(filter::info(term).name);
  return parameter.is_switch() ? parameter.name
                               : fmt::format("{} {}", parameter.name, parameter.text(parameters));
}

// "16 blocks of 1 pass", "2 blocks of 3 and 2 passes".
std::string block_text(std::size_t passes, std::size_t each) {
  const std::size_t blocks = (passes + each - 1) / each, rest = passes % each;
  const std::string count = core::counted(blocks, "block", "blocks");
  if (rest == 0) return fmt::format("{} of {}", count, core::counted(each, "pass", "passes"));
  return fmt::format("{} of {} and {} passes", count, each, rest);
}

class Planner {
 public:
  Planner(const run::Dump& dump, const AblateRequest& request, std::vector<std::string>& notes)
      : dump_(dump),
        parameters_(request.parameters),
        max_memory_(request.max_memory),
        notes_(notes),
        first_(request.passes.first),
        last_(run::last_pass(dump, request.passes)) {}

  void add_weights() {
    add(AblationPart::weights, "unfiltered", std::nullopt, last_);
    filter::Parameters parameters = parameters_;
    parameters.weights = filter::WeightTerms::none();
    add(AblationPart::weights, "no weights", parameters, last_);
    for (std::size_t k = 0; k < filter::kTermCount; ++k) {
      const auto term = static_cast<filter::Term>(k);
      if (!parameters_.weights.on(term)) continue;
      parameters.weights = parameters_.weights;
      for (std::size_t later = k + 1; later < filter::kTermCount; ++later) {
        parameters.weights.switch_off(static_cast<filter::Term>(later));
      }
      add(AblationPart::weights, "+ " + term_text(term, parameters), parameters, last_);
    }
  }

  void add_blocks() {
    const std::size_t passes = last_ - first_;
    std::vector<std::size_t> sizes = {1, (passes + 1) / 2, passes};
    sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
    for (const std::size_t each : sizes) {
      filter::Parameters parameters = parameters_;
      parameters.block.kind = filter::BlockSize::Kind::passes;
      parameters.block.passes = each;
      const std::string label = block_text(passes, each);
      try {
        add(AblationPart::blocks, label, parameters, last_);
      } catch (const Error& error) {
        if (error.code() != ErrorCode::limit) throw;
        notes_.push_back(fmt::format("there is no row of {}: {}", label, error.what()));
      }
    }
  }

  void add_iterations() {
    filter::Parameters parameters = parameters_;
    parameters.iterations = kIterations;
    for (const filter::Refusal& refusal : filter::info(parameters.estimator).refusals) {
      if (!refusal.applies(parameters)) continue;
      notes_.push_back(fmt::format("there are no iterations: {}", refusal.message));
      return;
    }
    add(AblationPart::iterations, "unfiltered", std::nullopt, first_ + 1);
    for (std::uint32_t k = 1; k <= kIterations; ++k) {
      parameters.iterations = k;
      add(AblationPart::iterations, fmt::format("iteration {}", k), parameters, first_ + 1);
    }
  }

  [[nodiscard]] std::vector<AblationRow> rows() && { return std::move(rows_); }

 private:
  // Throws Error{limit} where there is no room for the row.
  void add(AblationPart part, std::string label,
           const std::optional<filter::Parameters>& parameters, std::size_t last) {
    if (parameters) check_memory(*parameters, last);
    AblationRow row;
    row.part = part;
    row.label = std::move(label);
    row.parameters = parameters;
    row.first = first_;
    row.last = last;
    rows_.push_back(std::move(row));
  }
  void check_memory(const filter::Parameters& parameters, std::size_t last) const {
    constexpr std::uint64_t kBytesAPixel =
        run::CameraPictures::kBytesOfSums + run::CameraPictures::kBytesToWrite;
    static_cast<void>(run::plan_memory(dump_, dump_.select(parameters, false),
                                       {parameters, first_, last, max_memory_, kBytesAPixel}));
  }

  const run::Dump& dump_;
  const filter::Parameters& parameters_;
  std::optional<std::uint64_t> max_memory_;
  std::vector<std::string>& notes_;
  std::size_t first_, last_;  // passes
  std::vector<AblationRow> rows_;
};

// The mean luminance over the pixels that are finite.
double mean_of(std::span<const Rgb> picture) {
  double sum = 0;
  std::size_t count = 0;
  for (const Rgb& color : picture) {
    const double value = double{luminance(color)};
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

class Ablation {
 public:
  Ablation(const run::Dump& dump, const AblateRequest& request, std::vector<AblationRow>& rows)
      : dump_(dump), request_(request), rows_(rows) {
    for (const AblationRow& row : rows_) total_ += work_of(row);
  }

  void run() {
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (!rows_[k].parameters) continue;
      filter(k, k > 0 && !rows_[k - 1].parameters ? &rows_[k - 1] : nullptr);
      done_ += work_of(rows_[k]);
    }
  }

 private:
  // Paths times iterations.
  [[nodiscard]] std::uint64_t work_of(const AblationRow& row) const {
    if (!row.parameters) return 0;
    const std::vector<std::uint64_t>& bounds = dump_.pass_bounds();
    return (bounds[row.last] - bounds[row.first]) * row.parameters->iterations;
  }

  // Measures row k, and `unfiltered`, the same paths, where it is not null.
  void filter(std::size_t k, AblationRow* unfiltered) {
    AblationRow& row = rows_[k];
    run::FilterRequest run;
    run.parameters = *row.parameters;
    run.passes = {row.first, row.last};
    run.layers = run::PictureLayers::none();
    run.layers.unfiltered = unfiltered != nullptr;
    run.max_memory = request_.max_memory;
    run.on_progress = [&](std::uint64_t done, std::uint64_t) {
      if (request_.on_progress) {
        request_.on_progress(done_ + done * run.parameters.iterations, total_);
      }
    };
    const auto start = core::Clock::now();
    const run::FilterResult outcome = run::filter_dump(dump_, run);
    row.seconds = core::seconds_since(start);
    row.neighbors = outcome.statistics.mean_neighbors();
    row.orphans = outcome.statistics.orphans;
    row.left_out = outcome.statistics.left_out + outcome.statistics.without_source;
    const film::Image image = outcome.pictures[request_.camera].image();
    if (unfiltered != nullptr) {
      const std::vector<Rgb> before = image.rgb("unfiltered-input.");
      base_ = mean_of(before);
      finish(*unfiltered, before);
    }
    finish(row, image.rgb());
  }

  void finish(AblationRow& row, const std::vector<Rgb>& picture) const {
    row.mean = mean_of(picture);
    row.change = row.mean / base_ - 1;
    if (request_.reference != nullptr) row.metrics = request_.reference->measure(picture);
    if (request_.on_row) request_.on_row(row, picture);
  }

  const run::Dump& dump_;
  const AblateRequest& request_;
  std::vector<AblationRow>& rows_;
  double base_ = 0;                     // mean of the unfiltered picture of the same paths
  std::uint64_t done_ = 0, total_ = 0;  // paths times iterations
};

}  // namespace

const char* name(AblationPart part) {
  constexpr std::array<const char*, kAblationParts.size()> kNames = {"weights", "blocks",
                                                                     "iterations"};
  return kNames[static_cast<std::size_t>(part)];
}

std::string change_text(const AblationRow& row) {
  constexpr double kParts = 1e4;  // hundredths of a percent
  // Adding 0 makes 0 of -0.
  return fmt::format("{:+.2f}%", 100 * std::round(kParts * row.change) / kParts + 0.0);
}

std::vector<AblationRow> plan_ablation(const run::Dump& dump, const AblateRequest& request,
                                       std::vector<std::string>& notes) {
  Planner planner(dump, request, notes);
  planner.add_weights();
  planner.add_blocks();
  planner.add_iterations();
  return std::move(planner).rows();
}

void ablate(const run::Dump& dump, const AblateRequest& request, std::vector<AblationRow>& rows) {
  Ablation(dump, request, rows).run();
}

}  // namespace psf::study
