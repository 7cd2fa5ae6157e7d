#include "psf/explain.h"

#include <filesystem>
#include <mutex>

#include "core/apart.h"
#include "core/error.h"
#include "core/output_file.h"
#include "explain/ply.h"
#include "explain/report.h"
#include "psf/dump_state.h"
#include "psf/library.h"
#include "run/missing_terms.h"

namespace psf {

struct Explanation::State {
  std::shared_ptr<const Dump::State> of;  // its lock
  run::Dump dump;                         // with the vertex that was chosen
  explain::ExplainResult explanation;
  explain::Attribution whence;
  std::vector<std::string> notes;

  [[nodiscard]] explain::Report report(std::size_t rows, bool vertices) const {
    return {dump, explanation, whence, rows, vertices};
  }
  [[nodiscard]] std::string text(std::size_t rows, bool vertices) const {
    const std::shared_lock reading(of->mutex);
    return explain::overview(report(rows, vertices)) + explain::tables(report(rows, vertices));
  }
  // Explains the request's pixel or path; the caller holds the lock.
  static std::shared_ptr<const State> make(const std::shared_ptr<const Dump::State>& of,
                                           explain::ExplainRequest request,
                                           const Parameters& parameters,
                                           const ExplainOptions& options) {
    request.parameters = to_filter(parameters);
    const run::Dump dump = of->at(options.vertex);
    const std::string note = run::switch_off_missing(dump, {&request.parameters, 1},
                                                     filter::asked_terms(parameters.given()));
    request.passes = to_run(options.passes);
    request.on_progress = options.on_progress;
    explain::ExplainResult explanation = explain::explain(dump, request);
    explain::Attribution whence = explain::attribute(explanation);
    std::vector<std::string> notes;
    if (!note.empty()) notes.push_back(note);
    return std::make_shared<const State>(
        State{of, dump, std::move(explanation), std::move(whence), std::move(notes)});
  }
};

Explanation Dump::explain(std::uint32_t x, std::uint32_t y, const Parameters& parameters,
                          const ExplainOptions& options) const {
  const std::shared_lock reading(state_->mutex);
  explain::ExplainRequest request;
  request.camera = options.camera;
  request.x = x;
  request.y = y;
  return Explanation(Explanation::State::make(state_, std::move(request), parameters, options));
}

Explanation Dump::explain_path(std::uint64_t path, const Parameters& parameters,
                               const ExplainOptions& options) const {
  const std::shared_lock reading(state_->mutex);
  explain::ExplainRequest request;
  request.path = path;
  return Explanation(Explanation::State::make(state_, std::move(request), parameters, options));
}

std::string Explanation::text(std::size_t rows) const {
  return state_->text(rows, false);
}

std::string Explanation::whole_text() const {
  return state_->text(explain::kAllRows, true);
}

std::string Explanation::json() const {
  const std::shared_lock reading(state_->of->mutex);
  return explain::json(state_->report(explain::kAllRows, true)) + "\n";
}

const std::vector<std::string>& Explanation::notes() const {
  return state_->notes;
}

void Explanation::save(const std::string& path) const {
  core::check_files({state_->dump.reader().path()}, {path});
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".json") return core::write_text_file(path, json());
  if (extension != ".ply") {
    throw Error(ErrorCode::usage, path + ": an explanation is written as .json or .ply");
  }
  static_cast<void>(explain::write_ply(state_->explanation, state_->whence, path));
}

}  // namespace psf
