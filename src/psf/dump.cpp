#include "psf/dump.h"

#include <mutex>
#include <utility>

#include "core/error.h"
#include "psf/dump_state.h"
#include "psf/library.h"
#include "psf/version.h"
#include "run/attributes.h"
#include "run/filter_dump.h"
#include "run/missing_terms.h"

namespace psf {

Dump::Dump(const std::string& path) : state_(std::make_shared<State>(path)) {}
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
  request.passes = to_run(options.passes);
  if (!options.layers) request.layers = run::PictureLayers::none();
  request.max_memory = options.max_memory;
  request.on_progress = options.on_progress;
  return filter_with(state_->at(options.vertex), std::move(request), parameters);
}

std::vector<Camera> cameras_of(const run::Dump& dump) {
  std::vector<Camera> cameras;
  for (const formats::CameraInfo& camera : dump.metadata().cameras) {
    cameras.push_back({camera.name, camera.width, camera.height, camera.angle_per_pixel});
  }
  return cameras;
}

FilterResult filter_with(const run::Dump& dump, run::FilterRequest request,
                         const Parameters& parameters) {
  request.parameters = to_filter(parameters);
  FilterResult result;
  const std::string note = run::switch_off_missing(dump, {&request.parameters, 1},
                                                   filter::asked_terms(parameters.given()));
  if (!note.empty()) result.notes.push_back(note);
  const run::FilterResult done = run::filter_dump(dump, request);
  const film::Attributes attributes = run::attributes_of(PSF_VERSION, dump, request);
  for (std::size_t k = 0; k < done.pictures.size(); ++k) {
    const std::string& camera = dump.metadata().cameras[k].name;
    film::Image image = done.pictures[k].image();
    image.attributes.insert(image.attributes.begin(), attributes.begin(), attributes.end());
    film::add_picture(image.attributes, camera, request.passes.first,
                      request.passes.first + done.passes);
    result.pictures.push_back(to_picture(std::move(image), camera));
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

}  // namespace psf
