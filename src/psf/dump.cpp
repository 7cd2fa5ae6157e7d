#include "psf/dump.h"

#include <fmt/format.h>

#include <mutex>
#include <shared_mutex>

#include "core/error.h"
#include "metrics/reference.h"
#include "psf/library.h"
#include "psf/version.h"
#include "run/attributes.h"
#include "run/filter_dump.h"
#include "run/missing_terms.h"
#include "study/sweep.h"

namespace psf {

struct Dump::State {
  explicit State(const std::string& path) : dump(path) { describe(); }

  void describe() {
    channels.clear();
    cameras.clear();
    for (const formats::Channel& channel : dump.reader().head().channels) {
      channels.push_back({channel.name, std::string(formats::name_of(channel.type)),
                          channel.components, channel.encoding == formats::Encoding::octahedral});
    }
    for (const formats::CameraInfo& camera : dump.metadata().cameras) {
      cameras.push_back({camera.name, camera.width, camera.height, camera.angle_per_pixel});
    }
  }

  [[nodiscard]] std::size_t channel(std::string_view name) const {
    return dump.reader().require(name, "the caller");
  }

  run::Dump dump;
  mutable std::shared_mutex mutex;  // refresh() changes what the others read
  std::vector<Channel> channels;
  std::vector<Camera> cameras;
};

Dump::Dump(const std::string& path) : state_(std::make_unique<State>(path)) {}
Dump::~Dump() = default;
Dump::Dump(Dump&&) noexcept = default;
Dump& Dump::operator=(Dump&&) noexcept = default;

const std::string& Dump::path() const {
  return state_->dump.reader().path();
}
std::uint64_t Dump::records() const {
  return state_->dump.reader().records();
}
std::uint64_t Dump::passes() const {
  return state_->dump.reader().passes().size();
}
bool Dump::closed() const {
  return state_->dump.reader().closed();
}
std::string Dump::metadata() const {
  return state_->dump.reader().head().metadata;
}
const std::vector<Channel>& Dump::channels() const {
  return state_->channels;
}
const std::vector<Camera>& Dump::cameras() const {
  return state_->cameras;
}
bool Dump::refresh() {
  const std::unique_lock alone(state_->mutex, std::try_to_lock);
  if (!alone) throw Error(ErrorCode::usage, path() + ": is being read; refresh it afterwards");
  return state_->dump.refresh();
}

void Dump::read(std::string_view channel, std::uint64_t first, std::uint64_t count,
                std::span<std::byte> out) const {
  const std::shared_lock reading(state_->mutex);
  state_->dump.reader().read(state_->channel(channel), first, static_cast<std::size_t>(count), out);
}
void Dump::read_floats(std::string_view channel, std::uint64_t first, std::uint64_t count,
                       std::span<float> out) const {
  const std::shared_lock reading(state_->mutex);
  state_->dump.reader().read_floats(state_->channel(channel), first,
                                    static_cast<std::size_t>(count), out);
}

FilterResult Dump::filter(const Parameters& parameters, const FilterOptions& options) const {
  const std::shared_lock reading(state_->mutex);
  run::FilterRequest request;
  request.parameters = to_filter(parameters);
  FilterResult result;
  const std::string note = run::switch_off_missing(state_->dump, {&request.parameters, 1},
                                                   filter::asked_terms(parameters.given()));
  if (!note.empty()) result.notes.push_back(note);
  request.passes.first = static_cast<std::size_t>(options.passes.first);
  if (options.passes.last) request.passes.last = static_cast<std::size_t>(*options.passes.last);
  if (!options.layers) request.layers = {false, false, false, false, false};
  request.max_memory = options.max_memory;
  request.on_progress = options.on_progress;
  const run::FilterResult done = run::filter_dump(state_->dump, request);
  const film::Attributes attributes =
      run::attributes_of(PSF_VERSION, state_->dump, request.parameters);
  for (std::size_t k = 0; k < done.pictures.size(); ++k) {
    film::Image image = done.pictures[k].image();
    image.attributes = attributes;
    film::add_picture(image.attributes, state_->cameras[k].name, request.passes.first,
                      request.passes.first + done.passes);
    result.pictures.push_back(to_picture(std::move(image), state_->cameras[k].name));
  }
  result.passes = done.passes;
  result.blocks = done.blocks;
  result.sources = done.statistics.sources;
  result.queries = done.statistics.queries;
  result.orphans = done.statistics.orphans;
  result.left_out = done.statistics.left_out;
  result.neighbors = done.statistics.mean_neighbors();
  return result;
}

std::vector<SweepRow> Dump::sweep(const Picture& reference, std::span<const Parameters> sets,
                                  std::span<const std::string> metrics,
                                  const FilterOptions& options, std::size_t camera) const {
  const std::shared_lock reading(state_->mutex);
  if (camera >= state_->cameras.size()) {
    throw Error(ErrorCode::usage, fmt::format("`camera`: there is no camera {}", camera));
  }
  const Camera& seen_by = state_->cameras[camera];
  if (reference.width != seen_by.width || reference.height != seen_by.height) {
    throw Error(ErrorCode::bad_input,
                fmt::format("the reference has {} x {} pixels, the camera {} x {}", reference.width,
                            reference.height, seen_by.width, seen_by.height));
  }
  std::vector<metrics::Metric> measured;
  for (const std::string& metric : metrics) measured.push_back(metrics::parse_metric(metric));
  if (measured.empty()) measured = {metrics::Metric::rel_mse};
  const metrics::Reference prepared(colors_of(reference), reference.width, {}, measured);

  std::vector<filter::Parameters> rows;
  for (const Parameters& set : sets) {
    rows.push_back(to_filter(set));
    static_cast<void>(
        run::switch_off_missing(state_->dump, {&rows.back(), 1}, filter::asked_terms(set.given())));
  }
  std::vector<SweepRow> result(rows.size());
  study::SweepRequest request;
  request.rows = rows;
  request.passes.first = static_cast<std::size_t>(options.passes.first);
  if (options.passes.last) request.passes.last = static_cast<std::size_t>(*options.passes.last);
  request.camera = camera;
  request.max_memory = options.max_memory;
  request.on_progress = options.on_progress;
  request.on_row = [&](std::size_t number, const study::SweepRow& row, const std::vector<Rgb>&) {
    SweepRow& out = result[number];
    out.parameters = filter::describe(row.parameters);
    for (const metrics::Metric metric : measured) {
      out.errors.emplace_back(metrics::name(metric), row.metrics[metric]);
    }
    out.neighbors = row.neighbors;
    out.seconds = row.seconds;
  };
  study::run_sweep(state_->dump, prepared, request);
  return result;
}

}  // namespace psf
