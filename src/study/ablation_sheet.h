// An ablation as a contact sheet: every row's picture with its label and its error, the parts below
// each other.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "film/contact_sheet.h"
#include "metrics/metrics.h"
#include "study/ablate.h"

namespace psf::study {

class AblationSheet {
 public:
  // The reference that a sheet shows beside the pictures, and the metric that it tells.
  struct Truth {
    std::string file;
    std::span<const Rgb> picture;  // borrowed
    metrics::Metric metric = metrics::Metric::rel_mse;
    metrics::MetricOptions options = {};
  };

  // Throws what film::ContactSheet throws.
  AblationSheet(const run::Dump& dump, const AblateRequest& request,
                const film::SheetOptions& options, const std::optional<Truth>& truth);

  // Adds the rows of an ablation in their order.
  void add(const AblationRow& row, std::span<const Rgb> picture);
  [[nodiscard]] const film::ContactSheet& sheet() const { return sheet_; }

 private:
  [[nodiscard]] std::vector<std::string> head(const run::Dump& dump) const;
  [[nodiscard]] std::string heading(const AblationRow& row) const;
  [[nodiscard]] std::string detail(const AblationRow& row) const;
  void end_part();

  filter::Parameters parameters_;
  std::optional<Truth> truth_;
  std::optional<AblationPart> part_;  // of the rows added last
  std::size_t passes_ = 0;            // of all rows but those of iterations
  film::ContactSheet sheet_;
};

}  // namespace psf::study
