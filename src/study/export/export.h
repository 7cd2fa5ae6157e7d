// Writes a dump in the formats of other programs: numpy arrays, PLY point clouds, CSV.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/reader.h"
#include "study/export/export_records.h"

namespace psf::study {

struct ExportOutcome {
  std::uint64_t records = 0, passes = 0;  // selected
  std::uint64_t written = 0;              // records, points or rows
  // Left out of a point cloud: paths without vertex; positions that are not finite.
  std::uint64_t without_vertex = 0, non_finite = 0;
  std::vector<std::string> files;
  std::uint64_t bytes = 0;  // of all files
  double exposure = 0;      // of a point cloud's colours, in stops
};

// Steps done, of all; called from the calling thread, between batches.
using ExportProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

// All three: memory does not grow with the file; the output appears under its name only when whole.
// They throw what Reader throws, Error{usage} for passes that are not there, Error{bad_input} for
// channels that are not there or cannot be written so, Error{io}, Error{interrupted}.

// A folder with CHANNEL.npy for each channel (format version 1.0, little-endian, C order, (records,
// components) or (records,), the stored type; octahedral: f4 x 3), pass.npy (u4) and metadata.json
// (as in the file). `folder` must be empty or not be there.
[[nodiscard]] ExportOutcome export_npy(const formats::Reader& reader,
                                       const ExportSelection& selection, const std::string& folder,
                                       const ExportProgress& progress = {});

// A header line, then a row a record: record, pass, and the components of the channels. Numbers are
// the shortest that give the same value back; strings never need a locale. RFC 4180, but LF.
[[nodiscard]] ExportOutcome export_csv(const formats::Reader& reader,
                                       const ExportSelection& selection, const std::string& path,
                                       const ExportProgress& progress = {});

struct PlyOptions {
  // A channel, `radiance` (of the path: unfiltered + throughput x contribution), or `none`. How a
  // channel becomes a colour: export_colour.h.
  std::string colour = "contribution";
  std::optional<float> exposure = 0.0f;  // stops; not set: log-average luminance shown as 0.18
};

// A binary little-endian point cloud of the vertices: float x y z, nx ny nz where the file has
// normals, uchar red green blue, and for each component of the selected channels (none by default)
// a property scalar_NAME: float, or double for what a float cannot hold. Records without vertex or
// with a position that is not finite are left out, and counted.
[[nodiscard]] ExportOutcome export_ply(const formats::Reader& reader,
                                       const ExportSelection& selection, const PlyOptions& options,
                                       const std::string& path,
                                       const ExportProgress& progress = {});

}  // namespace psf::study
