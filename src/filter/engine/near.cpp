#include "filter/engine/near.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/engine/kernel.h"
#include "filter/engine/packets.h"

namespace psf::filter::engine {
namespace {

// The terms that do not ask for a radius: those of the walk are reaches, not radii.
WeightTerms without_plane(WeightTerms terms) {
  terms.plane.reset();
  return terms;
}

class TreeLists final : public Lists {
 public:
  TreeLists(const Problem& problem, std::span<const std::uint32_t> centers,
            std::span<const float> reach)
      : p_(problem),
        roles_{{}, {centers.begin(), centers.end()}, problem.roles.queries},
        reach_(reach),
        radius_(problem.records.size(), 0.0f),
        weights_(problem.records, without_plane(problem.weights.terms())),
        walked_{problem.records, roles_, radius_, weights_, {}, true},
        packets_(walked_),
        place_(problem.records.size()) {
    for (std::size_t k = 0; k < centers.size(); ++k) {
      radius_[centers[k]] = reach[k];
      place_[centers[k]] = static_cast<std::uint32_t>(k);
    }
  }

  [[nodiscard]] bool is_moderate() const { return packets_.is_moderate(); }

  void each(const Visit& visit) const override {
    const Tree& tree = packets_.tree();
    core::parallel_for(reach_.size(), Packets::kGrain, [&](std::size_t begin, std::size_t end) {
      core::throw_if_interrupted("no picture was written");
      Found found;
      std::array<std::vector<std::uint32_t>, kWidth> places;
      packets_.each(begin, end, [&](auto centers, auto nodes, Packet& packet) {
        find_sources(tree, weights_.terms(), nodes, packet, found);
        for (auto& of_lane : places) of_lane.clear();
        list_found(tree, found, places);
        for (std::size_t lane = 0; lane < centers.size(); ++lane) {
          std::vector<std::uint32_t>& near = places[lane];
          for (std::uint32_t& place : near) place = tree.order()[place];
          near.resize(alike_only(near, centers[lane]));
          visit(place_[centers[lane]], near);
        }
      });
    });
  }

 private:
  // Moves what is alike to the front of `near`, and returns how many these are. The walk has left
  // w_ij = 1 for the centre i, which is w_ji = 1 for terms that are the same both ways.
  [[nodiscard]] std::size_t alike_only(std::span<std::uint32_t> near, std::uint32_t center) const {
    const WeightTerms& terms = p_.weights.terms();
    const bool is_both_ways = !terms.plane && !terms.gloss;
    const auto end = std::remove_if(near.begin(), near.end(), [&](std::uint32_t i) {
      return i == center || !(is_both_ways || p_.alike(i, center));
    });
    return static_cast<std::size_t>(end - near.begin());
  }

  const Problem& p_;
  Roles roles_;  // the queries of the walk are the centres, its sources the problem's queries
  std::span<const float> reach_;
  std::vector<float> radius_;  // by record number
  Weights weights_;
  Problem walked_;
  Packets packets_;
  std::vector<std::uint32_t> place_;  // of a record among the centres
};

}  // namespace

std::unique_ptr<Lists> make_lists(const Problem& problem, std::span<const std::uint32_t> centers,
                                  std::span<const float> reach) {
  auto lists = std::make_unique<TreeLists>(problem, centers, reach);
  if (!lists->is_moderate()) return nullptr;
  return lists;
}

}  // namespace psf::filter::engine
