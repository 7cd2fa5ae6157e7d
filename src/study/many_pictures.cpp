#include "study/many_pictures.h"

#include <algorithm>

#include "core/parallel.h"

namespace psf::study {
namespace {

constexpr std::size_t kTogether = ManyPictures::kTogether;

std::size_t camera_of(const filter::Records& records, std::size_t i) {
  return records.camera.empty() ? 0 : records.camera[i];
}

Rgb unfiltered_of(const filter::Records& records, std::size_t i) {
  return records.unfiltered.empty() ? Rgb(0, 0, 0) : records.unfiltered[i];
}

Rgb mean(const double* sum, const double* more, double paths) {
  if (paths <= 0) return {0, 0, 0};
  return {static_cast<float>((sum[0] + more[0]) / paths),
          static_cast<float>((sum[1] + more[1]) / paths),
          static_cast<float>((sum[2] + more[2]) / paths)};
}

}  // namespace

ManyPictures::ManyPictures(const filter::CameraView& camera, std::size_t radii)
    : filtered_(core::range_count(radii, kTogether) * kTogether * 3 * camera.width * camera.height),
      u_(std::size_t{camera.width} * camera.height * 3),
      paths_(std::size_t{camera.width} * camera.height),
      input_(camera.width, camera.height) {}

void ManyPictures::add_record(const filter::Records& records, filter::Role role, std::size_t i) {
  if (role == filter::Role::left_out) return;
  const std::uint32_t pixel = records.pixel[i];
  const Rgb u = unfiltered_of(records, i);
  double* sum = &u_[std::size_t{pixel} * 3];
  sum[0] += double{u.x};
  sum[1] += double{u.y};
  sum[2] += double{u.z};
  ++paths_[pixel];
  if (role == filter::Role::no_vertex) input_.add(pixel, u);
  if (role != filter::Role::source) return;
  const Rgb &alpha = records.throughput[i], &c = records.contribution[i];
  const Rgb value(u.x + alpha.x * c.x, u.y + alpha.y * c.y, u.z + alpha.z * c.z);
  if (is_finite(value)) input_.add(pixel, value);
}

std::uint32_t ManyPictures::add_filtered(const filter::Records& records, std::size_t i,
                                         std::size_t begin, std::size_t count, const Rgb* c_bar) {
  const Rgb& alpha = records.throughput[i];
  const std::size_t group = begin / kTogether, first = begin % kTogether;
  double* sum = &filtered_[(group * paths_.size() + records.pixel[i]) * kTogether * 3];
  // What is not asked for is 0, so that all loops have one length.
  Rgb values[kTogether];
  std::fill(values, values + kTogether, Rgb(0, 0, 0));  // they are born with any value
  float check = 0;
  for (std::size_t k = 0; k < count; ++k) {
    values[first + k] = Rgb(alpha.x * c_bar[k].x, alpha.y * c_bar[k].y, alpha.z * c_bar[k].z);
  }
  for (const Rgb& value : values) check += 0 * value.x + 0 * value.y + 0 * value.z;
  std::uint32_t overflows = 0;
  if (!(check == 0)) {
    for (std::size_t k = 0; k < count; ++k) {
      if (is_finite(values[first + k])) continue;
      overflows |= 1u << k;
      values[first + k] = Rgb(0, 0, 0);
    }
  }
  for (std::size_t k = 0; k < kTogether; ++k) {
    sum[3 * k] += double{values[k].x};
    sum[3 * k + 1] += double{values[k].y};
    sum[3 * k + 2] += double{values[k].z};
  }
  return overflows;
}

void ManyPictures::leave_out(const filter::Records& records, std::size_t i, std::size_t k) {
  Missing& missing = missing_[{records.pixel[i], k}];
  const Rgb u = unfiltered_of(records, i);
  ++missing.paths;
  for (int c = 0; c < 3; ++c) missing.u[c] += double{u[c]};
}

std::vector<Rgb> ManyPictures::filtered(std::size_t k) const {
  std::vector<Rgb> picture(paths_.size());
  for (std::size_t pixel = 0; pixel < picture.size(); ++pixel) {
    picture[pixel] =
        mean(filtered_sum(pixel, k), &u_[pixel * 3], static_cast<double>(paths_[pixel]));
  }
  for (const auto& [where, missing] : missing_) {
    const auto& [pixel, radius] = where;
    if (radius != k) continue;
    const double* u = &u_[std::size_t{pixel} * 3];
    const double left[3] = {u[0] - missing.u[0], u[1] - missing.u[1], u[2] - missing.u[2]};
    picture[pixel] =
        mean(filtered_sum(pixel, k), left, static_cast<double>(paths_[pixel] - missing.paths));
  }
  return picture;
}

std::vector<Rgb> ManyPictures::unfiltered() const {
  const std::vector<float> values = input_.mean();
  std::vector<Rgb> picture(paths_.size());
  for (std::size_t pixel = 0; pixel < picture.size(); ++pixel) {
    picture[pixel] = Rgb(values[3 * pixel], values[3 * pixel + 1], values[3 * pixel + 2]);
  }
  return picture;
}

std::uint64_t add_slab(const filter::Records& records, const filter::Slab& slab,
                       std::span<ManyPictures> pictures) {
  struct Overflow {
    std::size_t record, radius;
  };
  std::vector<std::vector<Overflow>> overflows(core::range_count(slab.count, kTogether));
  core::parallel_for(slab.count, kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = 0; q < slab.queries.size(); ++q) {
      const std::size_t i = slab.queries[q];
      const Rgb* c_bar = &slab.c_bar[q * slab.count + begin];
      std::uint32_t bits = pictures[camera_of(records, i)].add_filtered(
          records, i, slab.first + begin, end - begin, c_bar);
      for (std::size_t k = begin; bits != 0; ++k, bits >>= 1) {
        if ((bits & 1) != 0) overflows[begin / kTogether].push_back({i, slab.first + k});
      }
    }
  });
  std::uint64_t count = 0;
  for (const std::vector<Overflow>& some : overflows) {
    count += some.size();
    for (const auto& [i, k] : some) pictures[camera_of(records, i)].leave_out(records, i, k);
  }
  return count;
}

}  // namespace psf::study
