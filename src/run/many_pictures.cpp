#include "run/many_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "run/path_radiance.h"

namespace psf::run {
namespace {

// c_bar without the radii for which it makes a path overflow that alpha c_bar does not: NaN there.
std::vector<Rgb> without_overflows(const Rgb& u, const Rgb& alpha, std::span<const Rgb> c_bar) {
  std::vector<Rgb> kept(c_bar.begin(), c_bar.end());
  for (Rgb& c : kept) {
    if (!is_finite(path_radiance(u, alpha, c))) c = Rgb(std::numeric_limits<float>::quiet_NaN());
  }
  return kept;
}

Rgb mean(const double* sum, const double* more, double paths) {
  if (paths <= 0) return {0, 0, 0};
  return {static_cast<float>((sum[0] + more[0]) / paths),
          static_cast<float>((sum[1] + more[1]) / paths),
          static_cast<float>((sum[2] + more[2]) / paths)};
}

void add_squares(const Rgb& value, double* squares) {
  for (int c = 0; c < 3; ++c) squares[c] += double{value[c]} * double{value[c]};
}

}  // namespace

ManyPictures::ManyPictures(const filter::CameraView& camera, std::size_t radii,
                           filter::PixelRule rule)
    : groups_(core::range_count(radii, kTogether)),
      filtered_(groups_ * kTogether * 3 * camera.width * camera.height),
      u_(std::size_t{camera.width} * camera.height * 3),
      paths_(std::size_t{camera.width} * camera.height),
      input_(camera.width, camera.height) {
  if (rule == filter::PixelRule::keep) return;
  squares_.resize(filtered_.size());
  u_squares_.resize(u_.size());
  features_ = PixelFeatures(camera);
}

bool ManyPictures::overflows(const filter::Records& records, filter::Role role, std::size_t i) {
  return role == filter::Role::source &&
         !is_finite(path_radiance(unfiltered_of(records, i), records.throughput[i],
                                  records.contribution[i]));
}

void ManyPictures::add_record(const filter::Records& records, filter::Role role, std::size_t i) {
  if (role == filter::Role::left_out || overflows(records, role, i)) return;
  const std::uint32_t pixel = records.pixel[i];
  const Rgb u = unfiltered_of(records, i);
  double* sum = &u_[std::size_t{pixel} * 3];
  sum[0] += double{u.x};
  sum[1] += double{u.y};
  sum[2] += double{u.z};
  ++paths_[pixel];
  if (!features_.empty()) {
    features_.add(records, role, i);
    if (!filter::is_query(role)) add_squares(u, &u_squares_[std::size_t{pixel} * 3]);
  }
  if (role == filter::Role::no_vertex) input_.add(pixel, u);
  if (role != filter::Role::source) return;
  input_.add(pixel, path_radiance(u, records.throughput[i], records.contribution[i]));
}

void ManyPictures::add_filtered(const filter::Records& records, std::size_t i, std::size_t first,
                                std::span<const Rgb> c_bar,
                                const std::function<void(std::size_t radius)>& overflows) {
  // A smaller u cannot make a float overflow that is one itself.
  constexpr float kLarge = 1e30f;
  const Rgb u = unfiltered_of(records, i);
  std::vector<Rgb> kept;
  if (std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)}) > kLarge) {
    kept = without_overflows(u, records.throughput[i], c_bar);
    c_bar = kept;
  }
  const std::size_t pixel = place_of(records.pixel[i], 0);
  for (std::size_t k = 0; k < c_bar.size();) {
    const std::size_t begin = (first + k) % kTogether, group = (first + k) / kTogether;
    const std::size_t count = std::min(kTogether - begin, c_bar.size() - k);
    const std::size_t place = pixel + group * kTogether * 3;
    std::uint32_t bits =
        add_group(u, records.throughput[i], &filtered_[place],
                  squares_.empty() ? nullptr : &squares_[place], begin, c_bar.subspan(k, count));
    for (std::size_t radius = first + k; bits != 0; ++radius, bits >>= 1) {
      if ((bits & 1) != 0) overflows(radius);
    }
    k += count;
  }
}

std::uint32_t ManyPictures::add_group(const Rgb& u, const Rgb& alpha, double* sum, double* squares,
                                      std::size_t first, std::span<const Rgb> c_bar) {
  constexpr std::size_t kValues = 3 * kTogether, kPattern = 12;
  static_assert(kValues % kPattern == 0);
  // What is not asked for is 0, so that all loops have one length, which compilers turn into
  // vectors.
  float value[kValues] = {}, factor[kPattern], check[4] = {};
  for (std::size_t k = 0; k < c_bar.size(); ++k) {
    for (int c = 0; c < 3; ++c) value[3 * (first + k) + static_cast<std::size_t>(c)] = c_bar[k][c];
  }
  for (std::size_t t = 0; t < kPattern; t += 3) {
    factor[t] = alpha.x;
    factor[t + 1] = alpha.y;
    factor[t + 2] = alpha.z;
  }
  for (std::size_t from = 0; from < kValues; from += kPattern) {
    for (std::size_t t = 0; t < kPattern; ++t) value[from + t] *= factor[t];
  }
  for (std::size_t from = 0; from < kValues; from += 4) {
    for (std::size_t t = 0; t < 4; ++t) check[t] += 0 * value[from + t];
  }
  std::uint32_t overflows = 0;
  if (!(check[0] + check[1] + check[2] + check[3] == 0)) {
    for (std::size_t k = 0; k < c_bar.size(); ++k) {
      float* one = value + 3 * (first + k);
      if (is_finite(Rgb(one[0], one[1], one[2]))) continue;
      overflows |= 1u << k;
      std::fill(one, one + 3, 0.0f);
    }
  }
  for (std::size_t t = 0; t < kValues; ++t) sum[t] += double{value[t]};
  if (squares == nullptr) return overflows;
  for (std::size_t k = 0; k < c_bar.size(); ++k) {
    if ((overflows >> k & 1) != 0) continue;
    const float* one = value + 3 * (first + k);
    add_squares(Rgb(u.x + one[0], u.y + one[1], u.z + one[2]), squares + 3 * (first + k));
  }
  return overflows;
}

void ManyPictures::leave_out(const filter::Records& records, std::size_t i, std::size_t k) {
  Missing& missing = missing_[{records.pixel[i], k}];
  const Rgb u = unfiltered_of(records, i);
  ++missing.paths;
  for (int c = 0; c < 3; ++c) missing.u[c] += double{u[c]};
}

ManyPictures::Paths ManyPictures::paths_of(std::uint32_t pixel, std::size_t k) const {
  const double* u = &u_[std::size_t{pixel} * 3];
  Paths paths = {static_cast<double>(paths_[pixel]), {u[0], u[1], u[2]}};
  const auto missing = missing_.find({pixel, k});
  if (missing == missing_.end()) return paths;
  paths.count -= static_cast<double>(missing->second.paths);
  for (int c = 0; c < 3; ++c) paths.u[c] -= missing->second.u[c];
  return paths;
}

std::vector<Rgb> ManyPictures::filtered(std::size_t k) const {
  std::vector<Rgb> picture(paths_.size());
  for (std::size_t pixel = 0; pixel < picture.size(); ++pixel) {
    const Paths paths = paths_of(static_cast<std::uint32_t>(pixel), k);
    picture[pixel] = mean(&filtered_[place_of(pixel, k)], paths.u, paths.count);
  }
  if (!features_.empty()) regress(k, picture);
  return picture;
}

void ManyPictures::regress(std::size_t k, std::vector<Rgb>& picture) const {
  const std::size_t size = picture.size();
  filter::PixelStatistics statistics = features_.statistics();
  std::vector<float> values(3 * size);
  for (std::size_t pixel = 0; pixel < size; ++pixel) {
    const Paths paths = paths_of(static_cast<std::uint32_t>(pixel), k);
    const double* sum = &filtered_[place_of(pixel, k)];
    const double* squares = &squares_[place_of(pixel, k)];
    double radiance[3], of_radiance[3];
    for (std::size_t c = 0; c < 3; ++c) {
      radiance[c] = sum[c] + paths.u[c];
      of_radiance[c] = squares[c] + u_squares_[3 * pixel + c];
      values[c * size + pixel] = picture[pixel][static_cast<int>(c)];
    }
    // Features stay those of all radii, but what is black for lack of paths is nobody's neighbour.
    statistics.paths[pixel] = static_cast<std::uint64_t>(paths.count);
    if (paths.count <= 0) statistics.vertices[pixel] = 0;
    PixelFeatures::set_radiance(statistics, pixel, paths.count, radiance, of_radiance);
  }
  std::vector<filter::PixelPlane> planes;
  for (std::size_t c = 0; c < 3; ++c) {
    planes.push_back({std::span(values).subspan(c * size, size), c});
  }
  filter::second_pass(statistics, planes);
  for (std::size_t pixel = 0; pixel < size; ++pixel) {
    picture[pixel] = Rgb(values[pixel], values[size + pixel], values[2 * size + pixel]);
  }
}

std::vector<Rgb> ManyPictures::unfiltered() const {
  const std::vector<float> values = input_.filled_mean();
  std::vector<Rgb> picture(paths_.size(), Rgb(0, 0, 0));
  for (std::size_t pixel = 0; pixel < picture.size(); ++pixel) {
    if (paths_[pixel] == 0) continue;
    picture[pixel] = Rgb(values[3 * pixel], values[3 * pixel + 1], values[3 * pixel + 2]);
  }
  return picture;
}

std::vector<Rgb> ManyPictures::u() const {
  constexpr double kNothing[3] = {};
  std::vector<Rgb> picture(paths_.size());
  for (std::size_t pixel = 0; pixel < picture.size(); ++pixel) {
    picture[pixel] = mean(&u_[pixel * 3], kNothing, static_cast<double>(paths_[pixel]));
  }
  return picture;
}

}  // namespace psf::run
