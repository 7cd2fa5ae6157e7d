// Writes a dump in the formats of other programs: numpy arrays, PLY point clouds, CSV.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "export/records.h"
#include "formats/read/reader.h"

namespace psf::exports {

struct ExportResult {
  std::uint64_t records = 0, passes = 0;  // numbers selected
  std::uint64_t written = 0;              // number of records, points or rows
  // Records left out of a point cloud: paths without vertex, and positions that are not finite.
  std::uint64_t without_vertex = 0, non_finite = 0;
  std::vector<std::string> files;
  std::uint64_t bytes = 0;  // size of all files
  double exposure = 0;      // exposure of a point cloud's colours, in stops
};

// Receives the number of steps done and of all steps; called from the calling thread, between
// batches.
using ExportProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

// For the three functions below: memory does not grow with the file, and the output appears under
// its name only when whole. They throw what Reader throws, Error{usage} for passes that do not
// exist, Error{bad_input} for channels that do not exist or cannot be written in this format,
// Error{io}, Error{interrupted}.

// Writes a folder with CHANNEL.npy for each channel (format version 1.0, little-endian, C order,
// shape (records, components) or (records,), the stored type; octahedral vectors as f4 x 3),
// pass.npy (u4) and metadata.json (as in the file). `folder` must be empty or not exist.
[[nodiscard]] ExportResult export_npy(const formats::Reader& reader,
                                      const ExportSelection& selection, const std::string& folder,
                                      const ExportProgress& progress = {});

// Writes a CSV table: a header line, then one row per record with record, pass, and the components
// of the channels. Numbers are the shortest that read back as the same value, and do not depend on
// the locale. The format is that of RFC 4180, but lines end with LF.
[[nodiscard]] ExportResult export_csv(const formats::Reader& reader,
                                      const ExportSelection& selection, const std::string& path,
                                      const ExportProgress& progress = {});

struct PlyOptions {
  // A channel, `radiance` (the path's unfiltered + throughput x contribution), or `none`.
  // colour.h says how a channel becomes a colour.
  std::string colour = "contribution";
  std::optional<float> exposure = 0.0f;  // stops; not set: the log-average luminance becomes 0.18
};

// Writes a binary little-endian point cloud of the vertices: float x y z, nx ny nz where the file
// has normals, uchar red green blue, and for each component of the selected channels (none by
// default) a property scalar_NAME, float, or double where a float cannot hold the values. Records
// without vertex or with a position that is not finite are left out, and counted.
[[nodiscard]] ExportResult export_ply(const formats::Reader& reader,
                                      const ExportSelection& selection, const PlyOptions& options,
                                      const std::string& path, const ExportProgress& progress = {});

}  // namespace psf::exports
