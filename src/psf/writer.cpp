#include "formats/write/writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"
#include "core/json_text.h"
#include "formats/layout/metadata.h"
#include "psf/dump.h"
#include "psf/version.h"

namespace psf {
namespace {

formats::Type type_of(const Channel& channel) {
  constexpr formats::Type kTypes[] = {formats::Type::u8,  formats::Type::u16, formats::Type::u32,
                                      formats::Type::u64, formats::Type::f16, formats::Type::f32,
                                      formats::Type::f64};
  std::string names;
  for (const formats::Type type : kTypes) {
    if (channel.type == formats::name_of(type)) return type;
    names += (names.empty() ? "" : ", ") + std::string(formats::name_of(type));
  }
  throw Error(ErrorCode::usage, fmt::format("channel {}: there is no type {}; there are {}",
                                            channel.name, channel.type, names));
}

// What `more` says, with these cameras.
std::string metadata_of(std::span<const Camera> cameras, const std::string& more) {
  formats::Metadata metadata = more.empty() ? formats::Metadata() : formats::parse_metadata(more);
  if (metadata.producer.empty()) metadata.producer = "psf library " PSF_VERSION;
  const std::vector<formats::CameraInfo> before = std::exchange(metadata.cameras, {});
  if (cameras.empty()) throw Error(ErrorCode::bad_input, "`cameras`: at least one is needed");
  for (const Camera& camera : cameras) {
    if (camera.width == 0 || camera.height == 0) {
      throw Error(ErrorCode::bad_input, fmt::format("camera {}: {} x {} is no size for a picture",
                                                    camera.name, camera.width, camera.height));
    }
    const auto same = std::find_if(before.begin(), before.end(),
                                   [&](const auto& info) { return info.name == camera.name; });
    formats::CameraInfo info = same != before.end() ? *same : formats::CameraInfo();
    info.name = camera.name;
    info.width = camera.width;
    info.height = camera.height;
    info.angle_per_pixel = camera.angle_per_pixel;
    metadata.cameras.push_back(info);
  }
  // Keys that mean nothing to psf stay.
  nlohmann::ordered_json all =
      more.empty() ? nlohmann::ordered_json::object() : nlohmann::ordered_json::parse(more);
  all.update(nlohmann::ordered_json::parse(formats::to_json(metadata)));
  return core::json_text(all);
}

formats::Head head_of(std::span<const Camera> cameras, std::span<const Channel> channels,
                      const std::string& more) {
  formats::Head head;
  for (const Channel& channel : channels) {
    head.channels.push_back(
        {channel.name, type_of(channel),
         static_cast<std::uint8_t>(std::min<std::size_t>(channel.components, 255)),
         channel.octahedral ? formats::Encoding::octahedral : formats::Encoding::plain});
  }
  head.metadata = metadata_of(cameras, more);
  return head;
}

}  // namespace

struct DumpWriter::State {
  State(formats::Writer made, std::span<const Channel> all)
      : writer(std::move(made)), channels(all.begin(), all.end()) {}

  std::mutex mutex;
  formats::Writer writer;
  std::vector<Channel> channels;
};

DumpWriter::DumpWriter(const std::string& path, std::span<const Camera> cameras,
                       std::span<const Channel> channels, const WriterOptions& options) {
  formats::WriterOptions chosen;
  chosen.codec = options.compress ? formats::Codec::zstd : formats::Codec::raw;
  state_ = std::make_unique<State>(
      formats::Writer(path, head_of(cameras, channels, options.metadata), chosen), channels);
}
DumpWriter::~DumpWriter() = default;
DumpWriter::DumpWriter(DumpWriter&&) noexcept = default;
DumpWriter& DumpWriter::operator=(DumpWriter&&) noexcept = default;

void DumpWriter::append(std::size_t count, std::span<const void* const> columns) {
  if (columns.size() != state_->channels.size()) {
    throw Error(ErrorCode::usage, fmt::format("`columns`: {} of them, the dump has {} channels",
                                              columns.size(), state_->channels.size()));
  }
  const std::lock_guard alone(state_->mutex);
  state_->writer.append(count, columns);
}
void DumpWriter::commit_pass() {
  const std::lock_guard alone(state_->mutex);
  state_->writer.commit();
}
void DumpWriter::close() {
  const std::lock_guard alone(state_->mutex);
  state_->writer.close();
}
const std::vector<Channel>& DumpWriter::channels() const {
  return state_->channels;
}
std::uint64_t DumpWriter::records() const {
  return state_->writer.records();
}
std::uint64_t DumpWriter::passes() const {
  return state_->writer.passes();
}

}  // namespace psf
