// A binary point cloud: Stanford's polygon file format with vertices alone.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "export/colour.h"
#include "export/export.h"
#include "export/file.h"
#include "export/ply_header.h"

namespace psf::exports {
namespace {

constexpr std::size_t kPointGrain = 4096;  // points made at a time by a thread
constexpr std::uint8_t kHasVertex = 1;     // bit of the channel `flags`
constexpr float kMiddleGrey = 0.18f;

// A channel written besides, as floats or doubles.
struct Scalars {
  std::size_t channel = 0, components = 1;
  formats::Type type = formats::Type::f32;  // type of the stored values, unless `floats`
  bool floats = false, wide = false;        // wide: written as doubles
  std::vector<std::byte> stored;
  std::vector<float> values;

  [[nodiscard]] double number(std::size_t index) const {
    std::uint64_t bits = 0;
    const std::size_t size = formats::size_of(type);
    std::memcpy(&bits, stored.data() + index * size, size);
    if (type != formats::Type::f64) return static_cast<double>(bits);
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
};

class Cloud {
 public:
  Cloud(const formats::Reader& reader, const ExportSelection& selection, const PlyOptions& options)
      : records_(reader, selection) {
    position_ = vector_of("position", true).value();
    normal_ = vector_of("normal", false);
    // Only of the paths do they tell whether there is a vertex.
    if (selection.table == formats::kPaths) flags_ = records_.schema().find("flags");
    if (flags_ && records_.schema().channels[*flags_].stride() != 1) flags_.reset();
    if (options.colour != "none") colours_.emplace(records_, options.colour);
    for (const std::size_t k : records_.find(selection.channels)) {
      const formats::Channel& channel = records_.schema().channels[k];
      const bool wide = channel.type == formats::Type::f64 || channel.type == formats::Type::u32 ||
                        channel.type == formats::Type::u64;
      const bool floats = is_float(channel) && !wide;
      scalars_.push_back({k, channel.decoded_components(), channel.type, floats, wide, {}, {}});
    }
  }

  // Which of the selected records are points, and how bright they are.
  void count(ExportResult& outcome, bool expose, const auto& step) {
    double sum = 0;
    std::uint64_t lit = 0;
    for_batches([&](std::uint64_t first, std::size_t count) {
      read_points(first, count, &outcome);
      if (expose) colours_->read(first, count);
      for (const std::size_t i : points_) {
        if (!expose) break;
        const float luminance = psf::luminance(colours_->linear(i));
        if (!(luminance > 0) || !std::isfinite(luminance)) continue;
        sum += std::log2(static_cast<double>(luminance));
        ++lit;
      }
      outcome.written += points_.size();
      step(count);
    });
    if (!expose) return;
    const double stops = lit > 0 ? std::log2(kMiddleGrey) - sum / static_cast<double>(lit) : 0;
    set_exposure(outcome, stops);
  }

  void set_exposure(ExportResult& outcome, double stops) {
    outcome.exposure = stops;
    if (colours_) colours_->set_exposure(static_cast<float>(stops));
  }

  [[nodiscard]] std::string header(std::uint64_t points) const {
    std::vector<PlyProperty> properties;
    const auto add = [&](std::string_view type, std::initializer_list<const char*> names) {
      for (const char* name : names) properties.push_back({type, name});
    };
    add("float", {"x", "y", "z"});
    if (normal_) add("float", {"nx", "ny", "nz"});
    if (colours_) add("uchar", {"red", "green", "blue"});
    for (const Scalars& scalars : scalars_) {
      for (std::size_t c = 0; c < scalars.components; ++c) {
        const auto& channel = records_.schema().channels[scalars.channel];
        properties.push_back(
            {scalars.wide ? "double" : "float", "scalar_" + component_name(channel, c)});
      }
    }
    return ply_header("psf export: vertices of light transport paths", points, properties);
  }

  void write(ExportFile& file, const auto& step) {
    std::vector<std::byte> rows;
    for_batches([&](std::uint64_t first, std::size_t count) {
      read_points(first, count, nullptr);
      if (normal_) records_.read_floats(*normal_, first, count, normals_);
      if (colours_) colours_->read(first, count);
      for (Scalars& scalars : scalars_) {
        if (scalars.floats) {
          records_.read_floats(scalars.channel, first, count, scalars.values);
        } else {
          records_.read(scalars.channel, first, count, scalars.stored);
        }
      }
      const std::size_t size = row_bytes();
      rows.resize(points_.size() * size);
      core::parallel_for(points_.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) put(rows.data() + k * size, points_[k]);
      });
      file.write(rows);
      step(count);
    });
  }

  [[nodiscard]] const ExportRecords& records() const { return records_; }
  [[nodiscard]] bool is_exposed() const { return colours_ && colours_->is_exposed(); }

 private:
  [[nodiscard]] std::optional<std::size_t> vector_of(const char* name, bool required) const {
    const formats::Schema& schema = records_.schema();
    const auto place =
        required ? records_.table().require(name, "a point cloud") : schema.find(name);
    if (!place) return place;
    const formats::Channel& channel = schema.channels[*place];
    if (is_float(channel) && channel.decoded_components() == 3) return place;
    if (!required) return std::nullopt;
    throw Error(
        ErrorCode::bad_input,
        fmt::format("{}: channel {} is {} x {}, expected 3 floats; see formats/README.md",
                    records_.path(), name, formats::name_of(channel.type), channel.components));
  }

  [[nodiscard]] std::size_t row_bytes() const {
    std::size_t bytes = 12u + (normal_ ? 12u : 0u) + (colours_ ? 3u : 0u);
    for (const Scalars& scalars : scalars_) {
      bytes += scalars.components * (scalars.wide ? sizeof(double) : sizeof(float));
    }
    return bytes;
  }

  void for_batches(const auto& body) const {
    const std::size_t batch =
        records_.batch(2 * row_bytes() + 16 + (colours_ ? colours_->bytes() : 0));
    for (std::uint64_t first = 0; first < records_.size(); first += batch) {
      core::throw_if_interrupted("nothing was exported");
      body(first,
           static_cast<std::size_t>(std::min<std::uint64_t>(batch, records_.size() - first)));
    }
  }

  // Fills positions_ and points_, the records of the batch that have a vertex at a finite place.
  void read_points(std::uint64_t first, std::size_t count, ExportResult* outcome) {
    records_.read_floats(position_, first, count, positions_);
    if (flags_) records_.read(*flags_, first, count, flag_values_);
    points_.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const float* x = &positions_[3 * i];
      const bool vertex = !flags_ || (std::to_integer<unsigned>(flag_values_[i]) & kHasVertex) != 0;
      const bool finite = std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
      if (vertex && finite) points_.push_back(i);
      if (outcome != nullptr && !vertex) ++outcome->without_vertex;
      if (outcome != nullptr && vertex && !finite) ++outcome->non_finite;
    }
  }

  void put(std::byte* to, std::size_t i) const {
    const auto copy = [&to](const void* from, std::size_t size) {
      std::memcpy(to, from, size);
      to += size;
    };
    copy(&positions_[3 * i], 12);
    if (normal_) copy(&normals_[3 * i], 12);
    if (colours_) copy(colours_->at(i).data(), 3);
    for (const Scalars& scalars : scalars_) {
      for (std::size_t c = 0; c < scalars.components; ++c) {
        const std::size_t index = i * scalars.components + c;
        if (scalars.floats) {
          copy(&scalars.values[index], sizeof(float));
        } else if (scalars.wide) {
          const double value = scalars.number(index);
          copy(&value, sizeof value);
        } else {
          const auto value = static_cast<float>(scalars.number(index));
          copy(&value, sizeof value);
        }
      }
    }
  }

  ExportRecords records_;
  std::size_t position_ = 0;
  std::optional<std::size_t> normal_, flags_;
  std::optional<PointColours> colours_;
  std::vector<Scalars> scalars_;
  std::vector<float> positions_, normals_;
  std::vector<std::byte> flag_values_;
  std::vector<std::size_t> points_;  // records of the batch that become points
};

}  // namespace

ExportResult export_ply(const formats::Reader& reader, const ExportSelection& selection,
                        const PlyOptions& options, const std::string& path,
                        const ExportProgress& progress) {
  Cloud cloud(reader, selection, options);
  ExportResult outcome;
  outcome.records = cloud.records().size();
  outcome.passes = cloud.records().passes();
  outcome.files = {path};
  core::OutputFile output(path);
  ExportFile file(output.temporary_path(), path);
  std::uint64_t done = 0;
  const auto step = [&](std::uint64_t count) {
    done += count;
    if (progress) progress(done, 2 * outcome.records);
  };
  cloud.set_exposure(outcome, static_cast<double>(options.exposure.value_or(0)));
  cloud.count(outcome, !options.exposure && cloud.is_exposed(), step);
  file.write(cloud.header(outcome.written));
  cloud.write(file, step);
  file.close();
  outcome.bytes = file.bytes();
  output.commit();
  return outcome;
}

}  // namespace psf::exports
