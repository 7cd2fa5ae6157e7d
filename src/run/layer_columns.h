// Reads the columns of the layers of the light: made finite, and empty where they are black.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "filter/blocks.h"
#include "formats/read/reader.h"
#include "run/block_records.h"
#include "run/light_layers.h"

namespace psf::run {

// Adds to `tasks`, which may run in parallel, what reads a column each of the paths [range.first,
// range.last) to out.layers. What is not finite is 0 there, and counted. A column without any light
// in the range is empty, which means the same. All but `tasks` must outlive them.
void add_layer_tasks(const formats::Reader& reader, const filter::PathRange& range,
                     std::span<const LightLayer> layers, BlockRecords& out,
                     std::vector<std::function<void()>>& tasks);

}  // namespace psf::run
