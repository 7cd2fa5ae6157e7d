// A dump that a test writes through the library.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "catch.h"
#include "psf/psf.h"

namespace psf::tests {

inline constexpr std::uint32_t kSide = 24;
inline const std::vector<Camera> kAbove = {{"above", kSide, kSide, 1.0 / kSide}};

// A plane of two colours seen from distance 1, lit by noise; one path a pixel and pass.
struct Plane {
  std::vector<float> position, throughput, contribution, distance, normal, reflectance;
  std::vector<std::uint32_t> pixel;

  explicit Plane(std::size_t passes, unsigned seed = 0) {
    std::mt19937 random(7 + seed);
    std::exponential_distribution<float> noise;
    const auto unit = [&random] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
    for (std::size_t i = 0; i < passes * kSide * kSide; ++i) {
      const auto in_pass = static_cast<std::uint32_t>(i % (kSide * kSide));
      const float x = (static_cast<float>(in_pass % kSide) + unit()) / kSide;
      const float y = (static_cast<float>(in_pass / kSide) + unit()) / kSide;
      const float rho = x < 0.5f ? 0.2f : 0.8f, c = rho * noise(random);
      position.insert(position.end(), {x, y, 0});
      throughput.insert(throughput.end(), {1, 0.5f, 1});
      contribution.insert(contribution.end(), {c, c, 2 * c});
      reflectance.insert(reflectance.end(), {rho, rho, rho});
      normal.insert(normal.end(), {0, 0, 1});
      distance.push_back(1);
      pixel.push_back(in_pass);
    }
  }

  [[nodiscard]] Records records() const {
    Records records;
    records.position = position;
    records.throughput = throughput;
    records.contribution = contribution;
    records.pixel = pixel;
    records.distance = distance;
    records.normal = normal;
    records.reflectance = reflectance;
    return records;
  }
};

inline const std::vector<Channel> kChannels = {
    {"position", "f32", 3}, {"throughput", "f32", 3}, {"contribution", "f32", 3},
    {"distance", "f32", 1}, {"normal", "f32", 3},     {"reflectance", "f32", 3},
    {"pixel", "u32", 1}};

// `more`: further metadata, with a comma before it.
inline void write(const std::string& path, const Plane& plane, std::size_t passes,
                  unsigned seed = 0, const std::string& more = "") {
  DumpWriter writer(path, kAbove, kChannels,
                    {true, "{\"seed\": " + std::to_string(seed) + more + "}"});
  const std::size_t count = kSide * kSide;
  for (std::size_t pass = 0; pass < passes; ++pass) {
    const std::size_t at = pass * count;
    const void* columns[] = {
        &plane.position[3 * at], &plane.throughput[3 * at], &plane.contribution[3 * at],
        &plane.distance[at],     &plane.normal[3 * at],     &plane.reflectance[3 * at],
        &plane.pixel[at]};
    writer.append(count, columns);
    writer.commit_pass();
  }
  writer.close();
  CHECK(writer.passes() == passes);
  CHECK(writer.records() == passes * count);
}

}  // namespace psf::tests
