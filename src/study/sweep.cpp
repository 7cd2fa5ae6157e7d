#include "study/sweep.h"

#include <algorithm>

#include "study/variants.h"

namespace psf::study {
namespace {

class Sweeper {
 public:
  Sweeper(const run::Dump& dump, const metrics::Reference& reference, const SweepRequest& sweep)
      : dump_(dump), reference_(reference), s_(sweep), groups_(group_variants(sweep.rows)) {}

  void run() {
    const std::vector<std::uint64_t>& bounds = dump_.pass_bounds();
    paths_ = bounds[run::last_pass(dump_, s_.passes)] - bounds[s_.passes.first];
    traversals_ = split(groups_, [this](const VariantGroup& group) {
      return run::radii_at_once(dump_, run_of({&group, 0, group.radii.size()}));
    });
    for (const Traversal& traversal : traversals_) {
      traverse(traversal);
      ++done_;
      if (s_.on_traversal) s_.on_traversal();
    }
  }

 private:
  [[nodiscard]] run::ManyRequest run_of(const Traversal& traversal) const {
    run::ManyRequest run = study::run_of(traversal);
    run.passes = s_.passes;
    run.max_memory = s_.max_memory;
    return run;
  }

  void traverse(const Traversal& traversal) {
    run::ManyRequest run = run_of(traversal);
    run.on_progress = [this](std::uint64_t done, std::uint64_t) {
      if (s_.on_progress) s_.on_progress(done_ * paths_ + done, traversals_.size() * paths_);
    };
    const run::ManyResult outcome = run::filter_many(dump_, run);
    const run::ManyPictures& pictures = outcome.pictures[s_.camera];
    if (done_ == 0 && s_.on_unfiltered) {
      const std::vector<Rgb> unfiltered = pictures.unfiltered();
      s_.on_unfiltered(reference_.measure(unfiltered), unfiltered);
    }
    for (std::size_t k = 0; k < traversal.count; ++k) {
      const filter::Statistics& statistics = outcome.statistics[k];
      const std::size_t row_number = traversal.row(k);
      const std::vector<Rgb> picture = pictures.filtered(k);
      SweepRow row;
      row.parameters = s_.rows[row_number];
      row.metrics = reference_.measure(picture);
      row.neighbors = statistics.mean_neighbors();
      row.first_radius = outcome.first_radius[k];
      row.last_radius = outcome.last_radius[k];
      row.orphans = statistics.orphans;
      row.left_out = statistics.left_out + statistics.without_source;
      row.seconds = outcome.seconds;
      row.shared = traversal.count;
      s_.on_row(row_number, row, picture);
    }
  }

  const run::Dump& dump_;
  const metrics::Reference& reference_;
  const SweepRequest& s_;
  std::vector<VariantGroup> groups_;
  std::vector<Traversal> traversals_;
  std::uint64_t paths_ = 0, done_ = 0;  // number of paths in a traversal; of traversals done
};

}  // namespace

void run_sweep(const run::Dump& dump, const metrics::Reference& reference,
               const SweepRequest& sweep) {
  Sweeper(dump, reference, sweep).run();
}

}  // namespace psf::study
