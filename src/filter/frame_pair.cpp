#include "filter/frame_pair.h"

#include <utility>

#include "filter/inputs.h"
#include "filter/problem.h"
#include "filter/scaled.h"

namespace psf::filter {
namespace {

template <class T>
std::vector<T> one_behind_other(bool wanted, std::span<const T> a, std::span<const T> b) {
  std::vector<T> all;
  if (!wanted) return all;
  all.reserve(a.size() + b.size());
  all.insert(all.end(), a.begin(), a.end());
  all.insert(all.end(), b.begin(), b.end());
  return all;
}

Roles roles_of_pair(const FrameSide& asks, const FrameSide& gives) {
  const std::size_t first = asks.records.size();
  Roles roles;
  roles.of.assign(first + gives.records.size(), Role::left_out);
  roles.queries = asks.roles.queries;
  for (const std::uint32_t i : roles.queries) roles.of[i] = Role::query;
  roles.sources.reserve(gives.roles.sources.size());
  for (const std::uint32_t j : gives.roles.sources) {
    roles.sources.push_back(static_cast<std::uint32_t>(first + j));
    roles.of[first + j] = Role::source;
  }
  return roles;
}

}  // namespace

FramePair::FramePair(const FrameSide& asks, const FrameSide& gives, std::span<const float> radius,
                     const WeightTerms& terms, bool rest)
    : first_(asks.records.size()),
      terms_(terms),
      flags_(one_behind_other(true, asks.records.flags, gives.records.flags)),
      positions_(
          rest ? one_behind_other(true, asks.records.rest_position, gives.records.rest_position)
               : one_behind_other(true, asks.records.position, gives.records.position)),
      normals_(one_behind_other(terms.normal || terms.plane || terms.gloss, asks.records.normal,
                                gives.records.normal)),
      directions_(one_behind_other(terms.direction || terms.gloss, asks.records.direction,
                                   gives.records.direction)),
      reflectances_(one_behind_other(terms.reflectance.has_value(), asks.records.reflectance,
                                     gives.records.reflectance)),
      visibilities_(
          one_behind_other(terms.visibility, asks.records.visibility, gives.records.visibility)),
      materials_(one_behind_other(terms.material, asks.records.material, gives.records.material)),
      hit_distances_(one_behind_other(terms.hit_distance.has_value(), asks.records.hit_distance,
                                      gives.records.hit_distance)),
      roughnesses_(one_behind_other(terms.gloss.has_value(), asks.records.roughness,
                                    gives.records.roughness)),
      radii_(radius.begin(), radius.end()),
      roles_(roles_of_pair(asks, gives)) {
  radii_.resize(flags_.size(), 0);
  terms_ = terms_in_use(view(), terms_);
}

Records FramePair::view() const {
  Records records;
  records.flags = flags_;
  records.position = positions_;
  records.normal = normals_;
  records.direction = directions_;
  records.reflectance = reflectances_;
  records.visibility = visibilities_;
  records.material = materials_;
  records.hit_distance = hit_distances_;
  records.roughness = roughnesses_;
  return records;
}

std::vector<Rgb> FramePair::behind_queries(std::span<const Rgb> of_gives) const {
  std::vector<Rgb> all(first_, Rgb(0, 0, 0));
  all.insert(all.end(), of_gives.begin(), of_gives.end());
  return all;
}

void FramePair::average(std::span<const std::vector<Rgb>> values, EngineKind engine,
                        std::span<std::vector<Rgb>> means,
                        std::span<std::uint32_t> neighbors) const {
  const Records records = view();
  const Scaled scaled(records, radii_);
  const Weights weights(scaled.records(), terms_);
  const Problem problem{scaled.records(), roles_, scaled.radius(), weights, {}, true};
  std::vector<Averaged> all;
  for (std::size_t k = 0; k < values.size(); ++k) all.push_back({values[k], means[k]});
  Statistics unused;
  make_engine(engine, problem)->apply(all, BallFit::mean, false, neighbors, unused);
}

}  // namespace psf::filter
