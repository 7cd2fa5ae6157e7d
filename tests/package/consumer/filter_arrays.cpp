// Filters records that are in memory: a plane, seen from above, lit by noise of mean 1.
#include <psf/psf.h>

#include <cmath>
#include <iostream>
#include <random>

int main() {
  constexpr unsigned kSide = 32;
  std::vector<float> position, throughput(3 * kSide * kSide, 1.0f), contribution;
  std::vector<std::uint32_t> pixel;
  std::mt19937 random(1);
  std::exponential_distribution<float> noise;
  for (unsigned i = 0; i < kSide * kSide; ++i) {
    const float c = noise(random);
    position.insert(position.end(), {float(i % kSide), float(i / kSide), 0.0f});
    contribution.insert(contribution.end(), {c, c, c});
    pixel.push_back(i);
  }
  const psf::Camera camera[] = {{"above", kSide, kSide}};
  const psf::FilteredRecords result = psf::filter_records(
      {position, throughput, contribution, pixel}, camera, psf::Parameters().set("r0", "4wu"));
  double error = 0;
  for (const float c_bar : result.c_bar) error += (c_bar - 1) * (c_bar - 1) / result.c_bar.size();
  std::cout << "mean squared error " << error << ", of 1 without filter\n";
  return error < 0.1 ? 0 : 1;
}
