#include "study/ablation_sheet.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/text.h"
#include "filter/parameters/text.h"
#include "filter/parameters/values.h"

namespace psf::study {
namespace {

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace

AblationSheet::AblationSheet(const run::Dump& dump, const AblateRequest& request,
                             const film::SheetOptions& options, const std::optional<Truth>& truth)
    : parameters_(request.parameters),
      truth_(truth),
      passes_(run::last_pass(dump, request.passes) - request.passes.first),
      sheet_(dump.cameras()[request.camera].width, dump.cameras()[request.camera].height, options) {
  sheet_.set_head(head(dump));
}

std::vector<std::string> AblationSheet::head(const run::Dump& dump) const {
  const std::string dump_name = file_name(dump.reader().path());
  std::string facts =
      fmt::format("estimator {}, r0 {}, delta {:.4g}", filter::info(parameters_.estimator).name,
                  filter::find_parameter("r0").text(parameters_), parameters_.radius.delta);
  if (parameters_.fit != filter::BallFit::mean) {
    facts += ", fit " + filter::find_parameter("fit").text(parameters_);
  }
  if (!parameters_.fireflies.keeps()) {
    facts += ", fireflies " + filter::to_text(parameters_.fireflies);
  }
  if (parameters_.pixels != filter::PixelRule::keep) {
    facts += ", pixels " + filter::find_parameter("pixels").text(parameters_);
  }
  std::vector<std::string> lines = {dump.metadata().scene.empty() ? dump_name
                                                                  : dump.metadata().scene};
  lines.push_back(
      fmt::format("{}, {}; {}", dump_name, core::counted(passes_, "pass", "passes"), facts));
  if (!truth_) return lines;
  const std::string settings = metrics::settings(truth_->metric, truth_->options);
  lines.push_back(fmt::format("{}{} of whole pictures against {}", metrics::name(truth_->metric),
                              settings.empty() ? "" : " (" + settings + ")",
                              file_name(truth_->file)));
  return lines;
}

std::string AblationSheet::heading(const AblationRow& row) const {
  switch (row.part) {
    case AblationPart::weights:
      return fmt::format("Weights one after another, block {}",
                         filter::find_parameter("block").text(parameters_));
    case AblationPart::blocks:
      return "Blocks filtered apart, all weights";
    case AblationPart::iterations:
      break;
  }
  return fmt::format("Iterations on pass {} alone, all weights", row.first);
}

std::string AblationSheet::detail(const AblationRow& row) const {
  const std::string change = row.parameters ? "mean " + change_text(row) : std::string();
  if (!truth_) return change.empty() ? fmt::format("mean {:#.4g}", row.mean) : change;
  return fmt::format("{} {:#.4g}{}{}", metrics::name(truth_->metric), row.metrics[truth_->metric],
                     change.empty() ? "" : ", ", change);
}

// The reference stands behind the weights.
void AblationSheet::end_part() {
  if (part_ == AblationPart::weights && truth_) {
    sheet_.add(truth_->picture, "reference", "what the errors are against");
  }
}

void AblationSheet::add(const AblationRow& row, std::span<const Rgb> picture) {
  if (part_ != row.part) {
    end_part();
    sheet_.add_section(heading(row));
    part_ = row.part;
  }
  sheet_.add(picture, row.label, detail(row));
}

}  // namespace psf::study
