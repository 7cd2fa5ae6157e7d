// Renders the fake scene into a dump and reads it back, for tests of the loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "fake_integrator.h"
#include "formats/read/reader.h"
#include "render/loop/render.h"
#include "temp_folder.h"

namespace psf::tests {

using namespace psf::render;

using Columns = std::map<std::string, std::vector<std::byte>>;

inline RenderSettings quiet_settings(std::uint64_t passes) {
  RenderSettings settings;
  settings.passes = passes;
  settings.cameras = {0};
  settings.quiet = true;
  return settings;
}

inline RenderResult render_to(const std::string& path, const RenderSettings& settings,
                              formats::Codec codec = formats::Codec::raw) {
  const Scene scene = two_camera_scene();
  const FakeIntegrator integrator;
  formats::WriterOptions options;
  options.codec = codec;
  options.sync = false;
  formats::Writer writer(path, make_head(scene, integrator, settings), options);
  return render::render(scene, integrator, settings, &writer);
}

inline Columns read_all(const std::string& path) {
  const formats::Reader reader(path);
  Columns columns;
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    const formats::Channel& channel = reader.head().channels[k];
    std::vector<std::byte> bytes(reader.records() * channel.stride());
    reader.read(k, 0, reader.records(), bytes);
    columns[channel.name] = std::move(bytes);
  }
  return columns;
}

template <class T>
std::vector<T> values(const Columns& columns, const std::string& channel) {
  const auto& bytes = columns.at(channel);
  std::vector<T> result(bytes.size() / sizeof(T));
  std::memcpy(static_cast<void*>(result.data()), bytes.data(), bytes.size());
  return result;
}

inline Columns columns_of(const RenderSettings& settings, std::size_t threads = 0) {
  const TempFolder folder;
  const core::ThreadLimit limit(threads);
  (void)render_to(folder / "a.pvb", settings);
  return read_all(folder / "a.pvb");
}

constexpr std::size_t kLeft = 96 * 64;
constexpr std::size_t kRight = 50 * 40;

}  // namespace psf::tests
