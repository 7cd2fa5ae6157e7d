// The head of an explained pixel's text: the pixel, its vertices, and what it is against its own
// paths.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "core/text.h"
#include "explain/words.h"
#include "filter/parameters/values.h"
#include "search/ball.h"

namespace psf::explain {
namespace {

// A firefly is worth a word from here on, and a standard error says something.
constexpr double kDominates = 0.2, kDominatesOwn = 0.5;
constexpr std::uint64_t kEnoughPaths = 4;

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(float value) {
    low = std::min(low, double{value});
    high = std::max(high, double{value});
  }
  [[nodiscard]] std::string text() const {
    return low == high ? fmt::format("{:.4g}", low) : fmt::format("{:.4g} to {:.4g}", low, high);
  }
};

std::string colour(const Colour& c) {
  return fmt::format("{:.4g} {:.4g} {:.4g}, luminance {:.4g}", c.x, c.y, c.z, luminance(c));
}

class Overview {
 public:
  explicit Overview(const Report& report)
      : report_(report), e_(report.explanation), v_(e_.vertices) {}

  std::string run() {
    const std::uint32_t first = e_.paths.front().vertex;
    const auto [x, y] = pixel_of(e_, first);
    const auto& cameras = report_.dump.metadata().cameras;
    const std::string& camera = cameras[v_.camera.empty() ? 0 : v_.camera[first]].name;
    text_ = fmt::format("{}: {}pixel {},{}{}\n", report_.dump.reader().path(),
                        e_.request.path ? fmt::format("path {}, ", *e_.request.path) : "", x, y,
                        camera.empty() ? "" : fmt::format(" of camera \"{}\"", shown(camera)));
    if (const auto& rule = report_.dump.vertex_rule()) line("vertex", to_text(*rule));
    paths();
    for (const ExplainedPath& path : e_.paths) {
      if (has_vertex(path)) own_.push_back(&path);
    }
    if (own_.empty()) {
      line("vertices", "none: nothing is averaged");
    } else {
      vertices();
      kinds();
      surfaces();
      balls();
      fit();
      fireflies();
    }
    values();
    return std::move(text_);
  }

 private:
  void line(const char* name, const std::string& value) {
    text_ += fmt::format("{:<10} {}\n", name, value);
  }

  void paths() {
    std::array<std::uint64_t, std::size(kFateNames)> fates{};
    for (const auto& path : e_.paths) ++fates[static_cast<std::size_t>(path.fate)];
    std::string list;
    for (std::size_t k = 0; k < fates.size(); ++k) {
      if (fates[k] == 0) continue;
      list += fmt::format("{}{} {}", list.empty() ? "" : ", ", core::with_commas(fates[k]),
                          kFateNames[k]);
    }
    line("paths", fmt::format("{}, from {} of the {}: {}", core::with_commas(e_.paths.size()),
                              core::counted(e_.blocks, "block", "blocks"),
                              core::counted(e_.passes, "pass", "passes"), list));
  }

  void vertices() {
    Vec3 low = v_.position[own_[0]->vertex], high = low;
    Range distance;
    for (const ExplainedPath* path : own_) {
      const Vec3& x = v_.position[path->vertex];
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], x[axis]);
        high[axis] = std::max(high[axis], x[axis]);
      }
      if (!v_.distance.empty()) distance.add(v_.distance[path->vertex]);
    }
    std::string text = point(low);
    if (low != high) text += " to " + point(high);
    if (!v_.distance.empty()) text += fmt::format(", {} from the camera", distance.text());
    line("vertices", text);
  }

  // How many are of which kind, where any is in a volume.
  void kinds() {
    std::map<std::uint8_t, std::uint64_t> counts;
    for (const ExplainedPath* path : own_) {
      if (!v_.kind.empty()) ++counts[v_.kind[path->vertex]];
    }
    if (!counts.contains(filter::kVolume)) return;
    std::string text;
    for (const auto& [kind, count] : counts) {
      text += fmt::format("{}{} of a {}", text.empty() ? "" : ", ", core::with_commas(count),
                          kind_name(kind));
    }
    line("kind", text);
  }

  // What the vertices have in common, and how far they differ.
  void surfaces() {
    const std::uint32_t first = own_[0]->vertex;
    const auto on_surface = std::find_if(own_.begin(), own_.end(), [this](const auto* path) {
      return !in_volume(v_, path->vertex);
    });
    const bool has_normal = !v_.normal.empty() && on_surface != own_.end();
    const Vec3 normal = has_normal ? v_.normal[(*on_surface)->vertex] : Vec3(0, 0, 0);
    double cosine = 1, reflectance = 0;
    std::set<std::uint32_t> materials, lights;
    for (const ExplainedPath* path : own_) {
      const std::uint32_t i = path->vertex;
      if (has_normal && !in_volume(v_, i)) {
        cosine = std::min(cosine, double{dot(normal, v_.normal[i])});
      }
      if (!v_.reflectance.empty()) {
        const float d_sq = search::distance_sq(v_.reflectance[first], v_.reflectance[i]);
        reflectance = std::max(reflectance, std::sqrt(double{d_sq}));
      }
      if (!v_.material.empty()) materials.insert(v_.material[i]);
      if (!v_.visibility.empty()) lights.insert(v_.visibility[i]);
    }
    if (has_normal) {
      const double angle = std::acos(std::max(cosine, -1.0)) * 180 / std::numbers::pi;
      line("normal",
           point(normal) +
               (angle < 0.05 ? "" : fmt::format(", others off by {:.1f} degrees", angle)));
    }
    if (!v_.reflectance.empty()) {
      line("albedo",
           point(v_.reflectance[first]) +
               (reflectance < 5e-4 ? "" : fmt::format(", others off by {:.3f}", reflectance)));
    }
    if (!v_.material.empty()) line("material", named(materials));
    if (!v_.visibility.empty()) line("lights", seen(lights));
  }
  [[nodiscard]] std::string named(const std::set<std::uint32_t>& materials) const {
    std::string text;
    for (const std::uint32_t material : materials) {
      text += (text.empty() ? "" : ", ") + material_text(report_.dump, material);
    }
    return text;
  }
  [[nodiscard]] std::string seen(const std::set<std::uint32_t>& lights) const {
    if (lights.size() > 2) return fmt::format("{} different sets are seen", lights.size());
    std::string text;
    for (const std::uint32_t bits : lights) {
      const std::string names = lights_text(report_.dump, bits);
      text += (text.empty() ? "" : ", or ") + (bits == 0 ? "none is seen" : names + " is seen");
    }
    return text;
  }

  void balls() {
    Range radius;
    double neighbors = 0, in_ball = 0;
    for (const ExplainedPath* path : own_) {
      radius.add(path->radius);
      neighbors += path->neighbors;
      in_ball += path->in_ball;
    }
    const filter::Parameters& parameters = e_.request.parameters;
    line("radius", fmt::format("{}, {}, delta {:.4g}, block {}", radius.text(),
                               filter::to_text(parameters.radius), parameters.radius.delta,
                               filter::to_text(parameters.block)));
    const auto n = static_cast<double>(own_.size());
    line("neighbors",
         fmt::format("mean {:.1f}, of {:.1f} in the ball", neighbors / n, in_ball / n));
  }

  void fit() {
    if (!fits(e_)) return;
    Range ridge, weight;
    std::uint64_t fitted = 0, held = 0;
    for (const ExplainedPath* path : own_) {
      if (!path->fit) continue;
      ++fitted;
      held += is_held(*path->fit) ? 1u : 0u;
      ridge.add(static_cast<float>(path->fit->ridge));
      for (std::size_t k = path->begin; k < path->end; ++k) {
        const ExplainedPair& pair = e_.pairs[k];
        if (pair.averaged) weight.add(static_cast<float>(times_mean(e_, pair)));
      }
    }
    if (fitted == 0) return line("fit", "linear, but of no ball: c_bar is its mean, or one source");
    line("fit", fmt::format("linear, ridge {}: a source weighs {} times what it does in a mean",
                            ridge.text(), weight.text()));
    if (held > 0) {
      line("", fmt::format("a colour of {} would be below 0, and is 0",
                           core::counted(held, "path", "paths")));
    }
    line("", "means in its place give " + colour(report_.whence.pixel.of_means));
  }

  void fireflies() {
    if (!dims(e_)) return;
    std::set<std::uint32_t> averaged, dimmed, giving;
    for (const ExplainedPair& pair : e_.pairs) {
      const bool is_one = firefly_at(e_, pair.vertex) != nullptr;
      if (pair.averaged) (is_one ? dimmed : averaged).insert(pair.vertex);
      if (pair.given > 0) giving.insert(pair.vertex);
    }
    const PixelSums& pixel = report_.whence.pixel;
    std::string text = fmt::format(
        "{} of the {} averaged, dimmed to what they keep", core::with_commas(dimmed.size()),
        core::counted(averaged.size() + dimmed.size(), "source", "sources"));
    if (spreads(e_)) {
      text = fmt::format("{}; {} {} {} of the filtered luminance", text,
                         core::with_commas(giving.size()), giving.size() == 1 ? "gives" : "give",
                         percent(luminance(pixel.given), luminance(pixel.filtered)));
    }
    line("fireflies", text);
    std::size_t own = 0;
    for (const ExplainedPath* path : own_) {
      const ExplainedFirefly* firefly = firefly_at(e_, path->vertex);
      if (firefly != nullptr && own++ < report_.top) line("", firefly_text(e_, *firefly));
    }
    if (own > report_.top) line("", fmt::format("and {} more", own - report_.top));
  }

  void values() {
    const PixelSums& pixel = report_.whence.pixel;
    if (pixel.paths == 0) return line("filtered", "no path is part of it");
    line("filtered", colour(pixel.filtered));
    const auto& sources = report_.whence.sources;
    if (pixel.own_paths == 0) return line("own paths", "none has a contribution to compare with");
    line("own paths", colour(*pixel.own));
    if (pixel.own_paths >= kEnoughPaths && pixel.brightest_share > kDominatesOwn) {
      line("",
           fmt::format("path {} alone is {:.0f}% of that",
                       e_.record[e_.paths[pixel.brightest].vertex], 100 * pixel.brightest_share));
    }
    if (own_.empty()) return;
    const double difference = luminance(pixel.difference), own = luminance(*pixel.own);
    std::string text = fmt::format("{:+.4g}", difference);
    if (own > 0) text += fmt::format(" ({:+.1f}%)", 100 * difference / own);
    if (pixel.own_paths < kEnoughPaths) {
      text += ", with too few paths of its own to tell it from noise";
    } else if (pixel.own_error > 0) {
      const double errors = std::abs(difference) / pixel.own_error;
      text +=
          fmt::format(", {:.1f} standard errors ({:.2g}) of its own paths: {}", errors,
                      pixel.own_error, errors < 2 ? "may be their noise" : "more than their noise");
    }
    line("difference", text);
    const double filtered = luminance(pixel.filtered);
    for (const SourceShare& source : sources) {
      if (filtered > 0 && sources.size() > 1 && luminance(source.share) > kDominates * filtered) {
        line("", fmt::format("source {} alone is {} of the filtered pixel",
                             e_.record[source.vertex], percent(luminance(source.share), filtered)));
      }
    }
  }

  const Report& report_;
  const ExplainResult& e_;
  const run::BlockRecords& v_;
  std::vector<const ExplainedPath*> own_;  // with a vertex
  std::string text_;
};

}  // namespace

std::string overview(const Report& report) {
  return Overview(report).run();
}

}  // namespace psf::explain
