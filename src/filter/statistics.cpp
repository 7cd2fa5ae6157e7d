#include "filter/statistics.h"

namespace psf::filter {

Statistics& Statistics::operator+=(const Statistics& other) {
  records += other.records;
  without_vertex += other.without_vertex;
  queries += other.queries;
  sources += other.sources;
  photons += other.photons;
  photons_left_out += other.photons_left_out;
  left_out += other.left_out;
  without_source += other.without_source;
  candidates += other.candidates;
  accepted += other.accepted;
  min_neighbors = std::min(min_neighbors, other.min_neighbors);
  max_neighbors = std::max(max_neighbors, other.max_neighbors);
  orphans += other.orphans;
  orphans_unmatched += other.orphans_unmatched;
  fireflies += other.fireflies;
  light += other.light;
  light_apart += other.light_apart;
  seconds_index += other.seconds_index;
  seconds_filter += other.seconds_filter;
  for (std::size_t k = 0; k < non_finite.size(); ++k) non_finite[k] += other.non_finite[k];
  for (std::size_t k = 0; k < refused.size(); ++k) refused[k] += other.refused[k];
  return *this;
}

}  // namespace psf::filter
