// The tree of lights against brute force: its probabilities are those of its samples, and no light
// that can arrive is left out.
#include <numeric>
#include <random>

#include "analytic_support.h"
#include "render/light/placed_choice.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

struct Emitter {
  LightBounds bounds;
  Vec3 corner, edge1, edge2;  // a triangle; a point where the edges are 0
};

Vec3 random_point(std::mt19937& generator, float half) {
  std::uniform_real_distribution<float> side(-half, half);
  return {side(generator), side(generator), side(generator)};
}

// Triangles that shine to their front, points, spots, and some that do not shine.
std::vector<Emitter> random_emitters(std::size_t count, std::mt19937& generator) {
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Emitter> emitters(count);
  for (std::size_t k = 0; k < count; ++k) {
    Emitter& e = emitters[k];
    e.corner = random_point(generator, 4);
    e.edge1 = e.edge2 = Vec3(0, 0, 0);
    e.bounds.intensity = k % 11 == 5 ? 0 : std::exp(6 * unit(generator));
    e.bounds.box = Imath::Box3f(e.corner);
    if (k % 3 == 0) continue;
    e.bounds.axis = random_direction(generator);
    if (k % 3 == 1) {
      const float inner = 1.5f * unit(generator), more = (1.57f - inner) * unit(generator);
      e.bounds.cos_normals = std::cos(inner);
      e.bounds.cos_spread = std::cos(more) - 1e-5f;
      continue;
    }
    e.edge1 = random_direction(generator) * (0.5f * unit(generator));
    e.edge2 = random_direction(generator) * (0.5f * unit(generator));
    e.bounds.axis = cross(e.edge1, e.edge2).normalized();
    e.bounds.cos_normals = 1;
    e.bounds.cos_spread = -1e-5f;
    e.bounds.box.extendBy(e.corner + e.edge1);
    e.bounds.box.extendBy(e.corner + e.edge2);
  }
  return emitters;
}

std::vector<LightBounds> bounds_of(const std::vector<Emitter>& emitters) {
  std::vector<LightBounds> bounds;
  for (const Emitter& e : emitters) bounds.push_back(e.bounds);
  return bounds;
}

// On surfaces and in volumes, among the emitters, beside them and far from them.
std::vector<Receiver> random_receivers(std::mt19937& generator) {
  std::vector<Receiver> receivers;
  for (int k = 0; k < 40; ++k) {
    Receiver at{random_point(generator, k % 4 == 0 ? 100.0f : 5.0f)};
    if (k % 5 != 0) at.normal = random_direction(generator);
    receivers.push_back(at);
  }
  return receivers;
}

// Whether a point of the emitter shines on the receiver, by a margin.
bool shines(const Emitter& e, const Vec3& point, const Receiver& at) {
  constexpr float kMargin = 1e-3f;
  if (e.bounds.intensity == 0) return false;
  const Vec3 toward = (point - at.position).normalized();
  if (at.normal != Vec3(0, 0, 0) && dot(at.normal, toward) < kMargin) return false;
  if (e.bounds.cos_normals <= -1) return true;
  const float widest = std::acos(e.bounds.cos_normals) + std::acos(e.bounds.cos_spread);
  return std::acos(std::clamp(-dot(e.bounds.axis, toward), -1.0f, 1.0f)) < widest - kMargin;
}

}  // namespace

TEST_CASE("A light tree samples every emitter in proportion to the probability that it tells") {
  std::mt19937 generator(3);
  for (const std::size_t count : {1u, 2u, 7u, 200u}) {
    const std::vector<Emitter> emitters = random_emitters(count, generator);
    const LightTree tree(bounds_of(emitters), 1e-3f);
    for (const Receiver& at : random_receivers(generator)) {
      constexpr int kSamples = 20000;
      std::vector<int> chosen(count);
      int none = 0;
      double moved = 0;
      for (int k = 0; k < kSamples; ++k) {
        float u = (static_cast<float>(k) + 0.5f) / kSamples, probability;
        const std::size_t emitter = tree.sample(at, u, probability);
        if (probability == 0) {
          ++none;
          continue;
        }
        REQUIRE(u >= 0);
        REQUIRE(u < 1);
        moved += double{u} - 0.5;
        REQUIRE(probability == tree.probability(at, emitter));
        ++chosen[emitter];
      }
      // Each has one part of [0, 1): what is counted is off by one at either end of it.
      double sum = 0;
      for (std::size_t e = 0; e < count; ++e) {
        const double expected = double{tree.probability(at, e)};
        REQUIRE(std::abs(chosen[e] - kSamples * expected) <= 2);
        sum += expected;
      }
      CHECK(sum + static_cast<double>(none) / kSamples == Approx(1).margin(1e-3));
      CHECK(std::abs(moved) < 2 + 0.01 * kSamples);
    }
  }
}

TEST_CASE("No emitter that shines on a place has probability 0 there") {
  std::mt19937 generator(4);
  std::uniform_real_distribution<float> unit(0, 1);
  int shining = 0, left_out = 0;
  for (const std::size_t count : {1u, 3u, 100u, 500u}) {
    const std::vector<Emitter> emitters = random_emitters(count, generator);
    const LightTree tree(bounds_of(emitters), 1e-3f);
    for (const Receiver& at : random_receivers(generator)) {
      for (std::size_t e = 0; e < count; ++e) {
        bool any = false;
        for (int k = 0; k < 16; ++k) {
          float b1 = unit(generator), b2 = unit(generator);
          if (b1 + b2 > 1) b1 = 1 - b1, b2 = 1 - b2;
          const Vec3 point = emitters[e].corner + emitters[e].edge1 * b1 + emitters[e].edge2 * b2;
          any = any || shines(emitters[e], point, at);
        }
        const float probability = tree.probability(at, e);
        if (any) {
          REQUIRE(probability > 0);
          ++shining;
        } else if (probability == 0) {
          ++left_out;
        }
      }
    }
  }
  CHECK(shining > 4000);
  CHECK(left_out > 4000);  // and it does tell them apart
}

TEST_CASE("Clusters of a cut hold every emitter that shines on a place once, and add up") {
  std::mt19937 generator(5);
  const std::vector<Emitter> emitters = random_emitters(300, generator);
  const LightTree tree(bounds_of(emitters), 1e-3f);
  std::size_t held = 0, single = 0;
  for (const Receiver& at : random_receivers(generator)) {
    const LightTree::Cut cut = tree.cut(at);
    REQUIRE(cut.count <= cut.clusters.size());
    std::vector<double> share(cut.count);
    for (std::size_t e = 0; e < emitters.size(); ++e) {
      if (!(tree.probability(at, e) > 0)) continue;
      const std::size_t k = tree.holder(cut, e);
      REQUIRE(k < cut.count);
      share[k] += double{tree.probability(at, e, cut.clusters[k].node)};
      ++held;
    }
    double sum = 0;
    for (std::size_t k = 0; k < cut.count; ++k) {
      CHECK(share[k] < 1 + 1e-4);
      sum += double{cut.clusters[k].importance};
      if (!tree.is_single(cut.clusters[k])) continue;
      CHECK(share[k] == 1);
      CHECK(tree.holder(cut, tree.emitter(cut.clusters[k])) == k);
      ++single;
    }
    CHECK(sum == Approx(cut.importance));
  }
  CHECK(held > 1000);
  CHECK(single > 100);
}

TEST_CASE("Points that bring half of the light are strong, those that bring a 32nd are not") {
  std::mt19937 generator(8);
  std::uniform_real_distribution<float> unit(0, 1);
  std::size_t strong = 0;
  for (int scene = 0; scene < 20; ++scene) {
    std::vector<LightBounds> points(600);
    for (LightBounds& point : points) {
      point.box = Imath::Box3f(random_point(generator, 4));
      point.intensity = std::exp(4 * unit(generator));
    }
    const PlacedChoice choice(LightTree(points, 1e-3f), {});
    for (const Receiver& at : random_receivers(generator)) {
      std::vector<double> brings;
      for (const LightBounds& point : points) {
        const Vec3 toward = point.box.min - at.position;
        const double cosine =
            at.normal == Vec3(0, 0, 0) ? 1 : double{dot(at.normal, toward.normalized())};
        brings.push_back(std::max(0.0, cosine) * double{point.intensity / length_sq(toward)});
      }
      const double all = std::accumulate(brings.begin(), brings.end(), 0.0);
      const PlacedChoice::Plan plan = choice.plan(at);
      for (std::size_t l = 0; l < points.size(); ++l) {
        if (brings[l] > all / 2) {
          CHECK(plan.is_strong(l));
          ++strong;
        }
        if (brings[l] < all / 32) CHECK_FALSE(plan.is_strong(l));
      }
    }
  }
  CHECK(strong > 30);
}

TEST_CASE("A plan has as many samples of each light as it tells, near ones and those at infinity") {
  std::mt19937 generator(6);
  constexpr std::size_t kNear = 40;
  std::vector<LightBounds> bounds = bounds_of(random_emitters(kNear, generator));
  bounds.resize(kNear + 3);  // those at infinity have no intensity
  std::vector<PlacedChoice::Distant> far;
  far.push_back({kNear, random_direction(generator), 1, 4});
  far.push_back({kNear + 1, random_direction(generator), 0.9f, 2});
  far.push_back({kNear + 2, Vec3(0, 0, 0), 1, 1});
  const PlacedChoice choice(LightTree(bounds, 1e-3f), far);
  bool some_strong = false;
  for (const Receiver& at : random_receivers(generator)) {
    constexpr int kSamples = 20000;
    std::vector<int> one(bounds.size()), planned(bounds.size());
    const PlacedChoice::Plan plan = choice.plan(at);
    for (std::size_t k = 0; k < plan.count; ++k) planned[plan.strong[k]] = kSamples;
    some_strong = some_strong || plan.count > 1;
    for (int k = 0; k < kSamples; ++k) {
      const float u = (static_cast<float>(k) + 0.5f) / kSamples;
      float probability;
      std::size_t light = choice.choose(at, u, probability);
      if (probability > 0) {
        REQUIRE(probability == choice.probability(at, light));
        ++one[light];
      }
      light = choice.choose_rest(at, plan, u, probability);
      if (probability > 0) {
        REQUIRE(probability == Approx(choice.expected(at, light)));
        REQUIRE_FALSE(plan.is_strong(light));
        ++planned[light];
      }
    }
    for (std::size_t l = 0; l < bounds.size(); ++l) {
      REQUIRE(std::abs(one[l] - kSamples * double{choice.probability(at, l)}) <= 2);
      REQUIRE(std::abs(planned[l] - kSamples * double{choice.expected(at, l)}) <= 3);
    }
  }
  CHECK(some_strong);
}
