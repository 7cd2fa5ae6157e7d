// The tables of an explained pixel's text: refusals, whence the light came, remedies, paths.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "core/text.h"
#include "explain/words.h"
#include "filter/parameters/text.h"
#include "filter/weights.h"

namespace psf::explain {
namespace {

// A remedy is worth a row if it refuses so much more of the leak than of the others, in shares.
constexpr double kWorthARow = 0.1, kTells = 0.25;

class Tables {
 public:
  explicit Tables(const Report& report)
      : report_(report), e_(report.explanation), w_(report.whence), v_(e_.vertices) {}

  std::string run() {
    if (!e_.pairs.empty()) {
      refusals();
      kinds();
      remedies();
      pixels();
      sources();
      fireflies();
    }
    paths();
    return std::move(text_);
  }

 private:
  template <typename... T>
  void say(fmt::format_string<T...> format, T&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<T>(values)...);
  }
  [[nodiscard]] std::size_t rows_of(std::size_t rows) const { return std::min(rows, report_.top); }
  void rest(std::size_t rows) {
    if (rows > report_.top) say("  and {} more\n", core::with_commas(rows - report_.top));
  }
  // A value of a channel, or a dash where the file has none.
  static std::string cell(const auto& column, int decimals, double value, const char* unit = "") {
    return column.empty() ? "-" : fmt::format("{:.{}f}{}", value, decimals, unit);
  }

  void refusals() {
    if (w_.refusals.empty()) {
      return say("\nno weight is on: {} in the balls, all averaged\n",
                 core::counted(w_.candidates, "pair", "pairs"));
    }
    say("\n{:<34}{:>12}{:>8}{:>12}{:>26}\n",
        core::counted(w_.candidates, "pair", "pairs") + " in the balls", "refused", "", "it alone",
        "luminance without it");
    for (const TermRefusals& of : w_.refusals) {
      say("  {:<32}{:>12}{:>8}{:>12}{:>26.4g}\n", term_text(of.term), core::with_commas(of.refused),
          percent(of.refused, w_.candidates), core::with_commas(of.alone), luminance(of.without));
    }
  }
  // As the run has it: "normal 0.95", "visibility".
  [[nodiscard]] std::string term_text(std::size_t term) const {
    for (const auto& [name, value] : filter::describe(e_.request.parameters)) {
      if (name == term_name(term)) return name + (value == "on" ? "" : " " + value);
    }
    return term_name(term);
  }

  void kinds() {
    if (w_.leak == 0) return;
    const bool lower = luminance(w_.pixel.difference) < 0;
    say("\n{} {}\n", core::counted(w_.sources.size(), "source is", "sources are"),
        fmt::format("averaged{}; {} {} all of the difference",
                    spreads(e_) ? " or give as fireflies" : "", core::with_commas(w_.leak),
                    w_.leak == 1 ? (lower ? "lowers the pixel by" : "raises the pixel by")
                                 : (lower ? "lower the pixel by" : "raise the pixel by")));
    if (w_.kinds.empty()) return;
    say("  {:<44}{:>10}{:>12}{:>12}{:>14}\n", "told from the vertex by", "pairs", "of those",
        "of others", "adds");
    for (std::size_t k = 0; k < rows_of(w_.kinds.size()); ++k) {
      const KindShare& kind = w_.kinds[k];
      say("  {:<44}{:>10}{:>12}{:>12}{:>+14.4g}\n", kind_text(kind.terms),
          core::with_commas(kind.pairs), percent(kind.leaking, w_.leak_pairs),
          percent(kind.pairs - kind.leaking, w_.other_pairs), luminance(kind.excess));
    }
    rest(w_.kinds.size());
  }
  static std::string kind_text(std::uint32_t terms) {
    std::string text;
    for (std::size_t k = 0; k < filter::kTermCount; ++k) {
      if (((terms >> k) & 1) != 0)
        text += (text.empty() ? "" : ", ") + std::string(filter::kTerms[k].apart);
    }
    return text.empty() ? "nothing" : text;
  }

  void remedies() {
    if (w_.leak == 0 || w_.leak_pairs == 0) return;
    bool told = false;
    for (const Remedy& remedy : w_.remedies) {
      const double gain = remedy.gain(w_.leak_pairs, w_.other_pairs);
      if (gain < kWorthARow) continue;
      if (!std::exchange(told, true)) {
        say("\n{:<34}{:>20}{:>20}{:>20}\n", "would have refused", "of those", "of others",
            "luminance with it");
      }
      const auto cost = [](std::uint64_t part, std::uint64_t all) {
        return core::with_commas(part) + fmt::format("{:>8}", percent(part, all));
      };
      say("  {:<32}{:>20}{:>20}{:>20.4g}\n",
          filter::kTermNames[remedy.term] +
              (remedy.threshold ? fmt::format(" {:g}", *remedy.threshold) : ""),
          cost(remedy.leaking, w_.leak_pairs), cost(remedy.others, w_.other_pairs),
          luminance(remedy.pixel));
    }
    if (w_.remedies.empty() || w_.remedies.front().gain(w_.leak_pairs, w_.other_pairs) < kTells) {
      say("\nno term tells those from the others: noise, or something that no weight looks at\n");
    }
  }

  void pixels() {
    say("\n{:<24}{:>9}{:>11}{:>11}{:>9}{:>9}{:>9}{:>10}{:>8}\n", "sources from pixel", "sources",
        "of those", "adds", "angle", "albedo", "lights", "material", "plane");
    const auto [x, y] = pixel_of(e_, e_.paths.front().vertex);
    for (std::size_t k = 0; k < rows_of(w_.pixels.size()); ++k) {
      const PixelShare& of = w_.pixels[k];
      const std::uint32_t width = e_.widths[of.camera];
      const std::uint32_t from_x = of.pixel % width, from_y = of.pixel / width;
      std::string name = fmt::format("{},{}", from_x, from_y);
      if (e_.widths.size() > 1)
        name += " " + shown(report_.dump.metadata().cameras[of.camera].name);
      else if (from_x == x && from_y == y)
        name += " itself";
      say("  {:<22}{:>9}{:>11}{:>+11.3g}{:>9}{:>9}{:>9}{:>10}{:>8}\n", name,
          core::with_commas(of.sources), percent(of.leaking, of.pairs), luminance(of.excess),
          cell(v_.normal, 1, of.angle), cell(v_.reflectance, 3, of.reflectance),
          cell(v_.visibility, 0, 100 * of.lights, "%"),
          cell(v_.material, 0, 100 * of.material, "%"), cell(v_.normal, 2, of.plane));
    }
    rest(w_.pixels.size());
  }

  void sources() {
    say("\n{:<12}{:>6}{:>10}{:>11}{:>8}{:>10}{:>8}{:>8}{:>9}{:>10}{:>8}", "source", "pass", "pixel",
        "adds", "share", "distance", "angle", "albedo", "lights", "material", "plane");
    if (fits(e_)) say("{:>9}", "weight");
    if (dims(e_)) say("{:>9}", "keeps");
    say("\n");
    for (std::size_t k = 0; k < rows_of(w_.sources.size()); ++k) {
      const SourceShare& source = w_.sources[k];
      const ExplainedPair& pair = e_.pairs[source.pair];
      const PairFeatures f = features_of(e_, pair);
      const auto [x, y] = pixel_of(e_, source.vertex);
      say("  {:<10}{:>6}{:>10}{:>+11.3g}{:>8}{:>10.3g}{:>8}{:>8}{:>9}{:>10}{:>8}",
          e_.record[source.vertex], e_.pass[source.vertex], fmt::format("{},{}", x, y),
          luminance(source.excess), percent(luminance(source.share), luminance(w_.pixel.filtered)),
          pair.distance, cell(v_.normal, 1, f.angle.value_or(0)),
          cell(v_.reflectance, 3, f.reflectance.value_or(0)), lights(pair, f), material(pair, f),
          cell(v_.normal, 2, f.plane.value_or(0)));
      if (fits(e_)) say("{:>9}", weight(pair));
      if (dims(e_)) say("{:>9}", kept(source.vertex));
      say("\n");
    }
    rest(w_.sources.size());
  }
  [[nodiscard]] std::string weight(const ExplainedPair& pair) const {
    return pair.averaged ? fmt::format("{:.2f}x", times_mean(e_, pair)) : "-";
  }
  [[nodiscard]] std::string kept(std::uint32_t vertex) const {
    const ExplainedFirefly* firefly = firefly_at(e_, vertex);
    return firefly != nullptr ? percent(double{firefly->kept}, 1.0) : "all";
  }

  // The fireflies among the sources, those first that add most to the pixel.
  void fireflies() {
    std::vector<const SourceShare*> rows;
    for (const SourceShare& source : w_.sources) {
      if (firefly_at(e_, source.vertex) != nullptr) rows.push_back(&source);
    }
    if (rows.empty()) return;
    std::stable_sort(rows.begin(), rows.end(), [](const auto* a, const auto* b) {
      return luminance(a->share) > luminance(b->share);
    });
    say("\n{:<12}{:>6}{:>10}{:>11}{:>11}{:>9}", "firefly", "pass", "pixel", "luminance", "ordinary",
        "keeps");
    if (spreads(e_)) say("{:>12}{:>10}{:>12}", "to sources", "within", "gives here");
    say("{:>12}{:>8}\n", "adds in all", "share");
    for (std::size_t k = 0; k < rows_of(rows.size()); ++k) {
      const SourceShare& source = *rows[k];
      const ExplainedFirefly& of = *firefly_at(e_, source.vertex);
      const auto [x, y] = pixel_of(e_, source.vertex);
      say("  {:<10}{:>6}{:>10}{:>11.4g}{:>11.4g}{:>9}", e_.record[source.vertex],
          e_.pass[source.vertex], fmt::format("{},{}", x, y), of.luminance, of.ordinary,
          kept(source.vertex));
      if (spreads(e_)) {
        say("{:>12}{:>10.3g}{:>12.3g}", core::with_commas(of.sources), of.reach,
            luminance(source.given));
      }
      say("{:>12.3g}{:>8}\n", luminance(source.share),
          percent(luminance(source.share), luminance(w_.pixel.filtered)));
    }
    rest(rows.size());
  }
  // What the source sees and the vertex does not, or the other way round.
  [[nodiscard]] std::string lights(const ExplainedPair& pair, const PairFeatures& features) const {
    if (!features.lights) return "-";
    if (*features.lights == 0) return "same";
    const std::uint32_t more = *features.lights & v_.visibility[pair.vertex];
    const std::string text = more == *features.lights ? "+" + lights_text(report_.dump, more)
                             : more == 0 ? "-" + lights_text(report_.dump, *features.lights)
                                         : "other";
    constexpr std::size_t kWidth = 8;
    return text.size() <= kWidth ? text : "other";
  }

  // What the source is of, where that is another than the vertex is of.
  [[nodiscard]] std::string material(const ExplainedPair& pair,
                                     const PairFeatures& features) const {
    if (!features.material) return "-";
    if (!*features.material) return "same";
    const std::string name = material_name(report_.dump, v_.material[pair.vertex]);
    constexpr std::size_t kWidth = 9;
    return name.empty() || name.size() > kWidth ? "other" : name;
  }

  void paths() {
    say("\n{:<12}{:>6}{:>12}{:>11}{:>10}{:>11}{:>11}{:>11}{:>11}", "path", "pass", "radius",
        "neighbors", "in ball", "alpha", "c", "c_bar", "u");
    if (fits(e_)) say("{:>11}", "if mean");
    if (spreads(e_)) say("{:>11}", "given");
    say("\n");
    const auto light = [](const Rgb& c) { return fmt::format("{:.4g}", psf::luminance(c)); };
    for (std::size_t p = 0; p < rows_of(e_.paths.size()); ++p) {
      const ExplainedPath& path = e_.paths[p];
      const std::uint32_t i = path.vertex;
      const std::string u = v_.unfiltered.empty() ? "0" : light(v_.unfiltered[i]);
      const char* fate = kFateNames[static_cast<std::size_t>(path.fate)];
      if (!has_vertex(path)) {
        say("  {:<10}{:>6}{:>23}{:>54}\n", e_.record[i], e_.pass[i], fate, u);
        continue;
      }
      const bool averaged = path.fate == PathFate::averaged;
      say("  {:<10}{:>6}{:>12.4g}{:>11}{:>10}{:>11}{:>11}{:>11}{:>11}", e_.record[i], e_.pass[i],
          path.radius, averaged ? core::with_commas(path.neighbors) : fate,
          core::with_commas(path.in_ball), light(v_.throughput[i]),
          e_.is_source[i] ? light(v_.contribution[i]) : "none", light(path.c_bar), u);
      if (fits(e_)) say("{:>11.4g}", luminance(if_mean(path)));
      if (spreads(e_)) say("{:>11}", light(path.given));
      say("\n");
      if (report_.vertices) vertex(i, path);
    }
    rest(e_.paths.size());
  }
  void vertex(std::uint32_t i, const ExplainedPath& path) {
    say("    x {}", point(v_.position[i]));
    if (!v_.normal.empty()) say(" n {}", point(v_.normal[i]));
    if (!v_.reflectance.empty()) say(" rho {}", point(v_.reflectance[i]));
    say("\n    alpha {} c {} c_bar {}", point(v_.throughput[i]), point(v_.contribution[i]),
        point(path.c_bar));
    if (!v_.unfiltered.empty()) say(" u {}", point(v_.unfiltered[i]));
    say("\n");
    if (path.fit) {
      say("    ridge {:.4g} mean {}{}\n", path.fit->ridge, point(path.fit->mean),
          is_held(*path.fit) ? ", a colour of the fit held at 0" : "");
    }
  }

  const Report& report_;
  const ExplainResult& e_;
  const Attribution& w_;
  const run::BlockRecords& v_;
  std::string text_;
};

}  // namespace

std::string tables(const Report& report) {
  return Tables(report).run();
}

}  // namespace psf::explain
