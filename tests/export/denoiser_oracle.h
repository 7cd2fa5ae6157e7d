// What denoisers get, read back, and what a naive loop over the samples finds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "../catch.h"
#include "../read_text.h"
#include "denoiser_case.h"
#include "export/denoisers.h"
#include "film/image.h"

namespace psf::tests {

inline exports::DenoiserResult write(exports::Denoiser denoiser, const std::string& dump,
                                     const std::string& folder,
                                     const run::PassSelection& passes = {}) {
  return exports::export_for(denoiser, run::Dump(dump), passes, folder, "1.2.3");
}

// (height, width, 3), row 0 at the top.
inline std::vector<float> read_pfm(const std::string& path, std::size_t width, std::size_t height) {
  const std::string text = read_text(path);
  const std::string header =
      "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
  REQUIRE(text.substr(0, header.size()) == header);
  REQUIRE(text.size() == header.size() + width * height * 12);
  std::vector<float> values(3 * width * height);
  for (std::size_t y = 0; y < height; ++y) {
    std::memcpy(&values[3 * width * y], &text[header.size() + 12 * width * (height - 1 - y)],
                12 * width);
  }
  return values;
}

// The values of one component of the samples that count.
using Values = std::vector<double>;
inline Values values_of(const std::vector<Sample>& samples, const std::string& what,
                        std::size_t c) {
  Values values;
  for (const Sample& s : samples) {
    if (what == "color" && !s.in_picture) continue;
    values.push_back(double{what == "color"    ? s.color[c]
                            : what == "albedo" ? s.albedo[c]
                            : what == "normal" ? s.normal[c]
                                               : s.depth});
  }
  return values;
}

inline double mean_of(const Values& values, std::size_t first = 0, std::size_t step = 1) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t k = first; k < values.size(); k += step, ++n) sum += values[k];
  return n > 0 ? sum / static_cast<double>(n) : 0;
}

inline bool near(float found, double expected) {
  return std::abs(double{found} - expected) <= 1e-6 * std::abs(expected) + 1e-12;
}

// How many pixels of a channel are not what `expected` of the pixel's samples is; counts pixels.
inline std::size_t wrong(const film::Image& image, const std::string& channel,
                         const std::vector<std::vector<Sample>>& pixels,
                         const std::function<double(const std::vector<Sample>&)>& expected) {
  const std::vector<float>* plane = image.find(channel);
  REQUIRE(plane != nullptr);
  REQUIRE(plane->size() == pixels.size());
  std::size_t count = 0;
  for (std::size_t pixel = 0; pixel < pixels.size(); ++pixel) {
    count += near((*plane)[pixel], expected(pixels[pixel])) ? 0u : 1u;
  }
  return count;
}

}  // namespace psf::tests
