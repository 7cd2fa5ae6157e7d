// An explained pixel as JSON.
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/json_text.h"
#include "explain/words.h"
#include "filter/parameters/text.h"
#include "filter/weights.h"

namespace psf::explain {
namespace {

using Json = nlohmann::ordered_json;

// What is no number is null, as JSON wants it; an infinite hit distance is a miss.
Json json_number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
template <typename V>
Json triple(const V& v) {
  return Json::array({json_number(static_cast<double>(v.x)), json_number(static_cast<double>(v.y)),
                      json_number(static_cast<double>(v.z))});
}
Json json_number(const std::optional<double>& value) {
  return value ? json_number(*value) : Json(nullptr);
}

class JsonWriter {
 public:
  explicit JsonWriter(const Report& report) : report_(report), e_(report.explanation) {}

  [[nodiscard]] Json all() const {
    const ExplainRequest& request = e_.request;
    const Attribution& w = report_.whence;
    Json json = {{"input", report_.dump.reader().path()}, {"uuid", report_.dump.reader().uuid()}};
    if (const auto& rule = report_.dump.vertex_rule()) json["vertex"] = to_text(*rule);
    for (const auto& [name, value] : filter::describe(request.parameters)) {
      json["parameters"][name] = value;
    }
    if (request.path) {
      json["path"] = *request.path;
    } else {
      json["camera"] = report_.dump.metadata().cameras[request.camera].name;
      json["pixel"] = {request.x, request.y};
    }
    json["passes"] = e_.passes;
    json["blocks"] = e_.blocks;
    json["value"] = value(w.pixel);
    if (dims(e_)) json["fireflies"] = fireflies();
    json["candidates"] = w.candidates;
    json["refusals"] = Json::array();
    for (const TermRefusals& of : w.refusals) {
      json["refusals"].push_back({{"term", term_name(of.term)},
                                  {"refused", of.refused},
                                  {"alone", of.alone},
                                  {"pixel_without", triple(of.without)}});
    }
    json["leak"] = {{"sources", w.leak}, {"pairs", w.leak_pairs}, {"other_pairs", w.other_pairs}};
    json["remedies"] = remedies();
    json["kinds"] = kinds();
    json["pixels"] = pixels();
    json["sources"] = sources();
    json["paths"] = Json::array();
    for (std::size_t p = 0; p < e_.paths.size(); ++p) json["paths"].push_back(path(p));
    return json;
  }

 private:
  [[nodiscard]] Json value(const PixelSums& pixel) const {
    const bool own = pixel.own.has_value();
    Json value = {
        {"paths", pixel.paths},
        {"filtered", triple(pixel.filtered)},
        {"own_paths", pixel.own_paths},
        {"own", own ? triple(*pixel.own) : Json(nullptr)},
        {"own_luminance_error", own ? Json(pixel.own_error) : Json(nullptr)},
        {"brightest_path", own ? Json(record(e_.paths[pixel.brightest].vertex)) : Json(nullptr)},
        {"brightest_share", pixel.brightest_share},
        {"own_contribution", triple(pixel.baseline)},
        {"difference", triple(pixel.difference)}};
    if (fits(e_)) value["of_means"] = triple(pixel.of_means);
    if (spreads(e_)) value["given"] = triple(pixel.given);
    return value;
  }

  // All among the vertices, in the order of the dump.
  [[nodiscard]] Json fireflies() const {
    Json list = Json::array();
    for (const ExplainedFirefly& firefly : e_.fireflies) {
      Json row = {{"record", record(firefly.vertex)}};
      row.update(facts(firefly));
      list.push_back(row);
    }
    return list;
  }
  [[nodiscard]] Json facts(const ExplainedFirefly& firefly) const {
    Json row = {{"luminance", json_number(double{firefly.luminance})},
                {"ordinary", json_number(firefly.ordinary)},
                {"kept", firefly.kept}};
    if (spreads(e_)) {
      row["reach"] = json_number(double{firefly.reach});
      row["given_to"] = firefly.sources;
    }
    return row;
  }

  [[nodiscard]] Json remedies() const {
    Json list = Json::array();
    for (const Remedy& remedy : report_.whence.remedies) {
      list.push_back({{"term", filter::kTermNames[remedy.term]},
                      {"threshold", remedy.threshold ? Json(*remedy.threshold) : Json(nullptr)},
                      {"refuses_of_leak", remedy.leaking},
                      {"refuses_of_others", remedy.others},
                      {"pixel", triple(remedy.pixel)}});
    }
    return list;
  }

  [[nodiscard]] Json kinds() const {
    Json list = Json::array();
    for (const KindShare& kind : report_.whence.kinds) {
      list.push_back({{"apart_by", names(kind.terms)},
                      {"pairs", kind.pairs},
                      {"of_leak", kind.leaking},
                      {"excess", triple(kind.excess)}});
    }
    return list;
  }

  [[nodiscard]] Json pixels() const {
    Json list = Json::array();
    for (const PixelShare& pixel : report_.whence.pixels) {
      const std::uint32_t width = e_.widths[pixel.camera];
      list.push_back({{"camera", pixel.camera},
                      {"pixel", {pixel.pixel % width, pixel.pixel / width}},
                      {"sources", pixel.sources},
                      {"pairs", pixel.pairs},
                      {"of_leak", pixel.leaking},
                      {"share", triple(pixel.share)},
                      {"excess", triple(pixel.excess)},
                      {"angle", pixel.angle},
                      {"reflectance", pixel.reflectance},
                      {"lights", pixel.lights},
                      {"plane", pixel.plane},
                      {"material", pixel.material}});
    }
    return list;
  }

  [[nodiscard]] Json sources() const {
    Json list = Json::array();
    for (std::size_t k = 0; k < report_.whence.sources.size(); ++k) {
      const SourceShare& source = report_.whence.sources[k];
      Json row = vertex(source.vertex);
      row["leak"] = k < report_.whence.leak;
      row["paths"] = source.paths;
      row["share"] = triple(source.share);
      row["excess"] = triple(source.excess);
      if (spreads(e_)) row["given"] = triple(source.given);
      row["apart"] = apart(source.pair);
      list.push_back(row);
    }
    return list;
  }

  [[nodiscard]] Json apart(std::size_t pair) const {
    const PairFeatures f = features_of(e_, e_.pairs[pair]);
    return {{"angle", json_number(f.angle)},
            {"reflectance", json_number(f.reflectance)},
            {"lights", f.lights ? Json(*f.lights) : Json(nullptr)},
            {"hit_distance", json_number(f.hit_distance)},
            {"plane", json_number(f.plane)},
            {"direction", json_number(f.direction)},
            {"material", f.material ? Json(*f.material) : Json(nullptr)}};
  }

  [[nodiscard]] std::uint64_t record(std::uint32_t v) const { return e_.record[v]; }
  [[nodiscard]] Json pixel(std::uint32_t v) const {
    const auto [x, y] = pixel_of(e_, v);
    return Json::array({x, y});
  }
  static Json names(std::uint32_t bits) {
    Json list = Json::array();
    for (std::size_t k = 0; k < filter::kTermCount; ++k) {
      if (((bits >> k) & 1) != 0) list.push_back(filter::kTermNames[k]);
    }
    return list;
  }

  // A record with all the channels that were read.
  [[nodiscard]] Json vertex(std::uint32_t i) const {
    const run::BlockRecords& v = e_.vertices;
    Json row = {{"record", record(i)}, {"pass", e_.pass[i]}, {"pixel", pixel(i)}};
    const auto put = [&row, i](const char* name, const auto& column, auto make) {
      if (!column.empty()) row[name] = make(column[i]);
    };
    const auto as_is = [](auto n) { return Json(n); };
    const auto real = [](float n) { return json_number(double{n}); };
    const auto vec = [](const Vec3& n) { return triple(n); };
    put("camera", v.camera, as_is);
    put("position", v.position, vec);
    put("normal", v.normal, vec);
    put("reflectance", v.reflectance, vec);
    put("distance", v.distance, real);
    put("throughput", v.throughput, vec);
    put("contribution", v.contribution, vec);
    put("unfiltered", v.unfiltered, vec);
    put("visibility", v.visibility, as_is);
    put("hit_distance", v.hit_distance, real);
    put("direction", v.direction, vec);
    put("material", v.material, as_is);
    put("kind", v.kind, [](std::uint8_t kind) { return Json(kind_name(kind)); });
    if (!v.material.empty()) {
      const std::string name = material_name(report_.dump, v.material[i]);
      if (!name.empty()) row["material_name"] = name;
    }
    return row;
  }

  [[nodiscard]] Json path(std::size_t p) const {
    const ExplainedPath& of = e_.paths[p];
    Json row = vertex(of.vertex);
    row["fate"] = kFateNames[static_cast<std::size_t>(of.fate)];
    row["radius"] = json_number(double{of.radius});
    row["c_bar"] = triple(of.c_bar);
    row["averaged"] = of.neighbors;
    row["in_ball"] = of.in_ball;
    if (fits(e_)) row["fit"] = of.fit ? fit(*of.fit) : Json(nullptr);
    if (spreads(e_)) row["given"] = triple(of.given);
    if (dims(e_)) {
      const ExplainedFirefly* firefly = firefly_at(e_, of.vertex);
      row["firefly"] = firefly != nullptr ? facts(*firefly) : Json(nullptr);
    }
    row["neighbors"] = neighbors(of);
    return row;
  }

  static Json fit(const ExplainedFit& fit) {
    return {{"ridge", json_number(fit.ridge)},
            {"mean", triple(fit.mean)},
            {"held_at_0", {fit.taken.x < 1, fit.taken.y < 1, fit.taken.z < 1}}};
  }

  [[nodiscard]] Json neighbors(const ExplainedPath& of) const {
    std::vector<const char*> columns = {"record",   "pass",         "pixel",
                                        "distance", "contribution", "share",
                                        "averaged", "in_ball",      "refused_by"};
    if (fits(e_)) columns.push_back("weight");
    if (dims(e_)) columns.push_back("kept");
    if (spreads(e_)) columns.push_back("given");
    Json n;
    for (const char* column : columns) n[column] = Json::array();
    for (std::size_t k = of.begin; k < of.end; ++k) {
      const ExplainedPair& pair = e_.pairs[k];
      n["record"].push_back(record(pair.vertex));
      n["pass"].push_back(e_.pass[pair.vertex]);
      n["pixel"].push_back(pixel(pair.vertex));
      n["distance"].push_back(pair.distance);
      n["contribution"].push_back(triple(e_.vertices.contribution[pair.vertex]));
      n["share"].push_back(triple(share_of(e_, pair, report_.whence.pixel.paths)));
      n["averaged"].push_back(pair.averaged);
      n["in_ball"].push_back(pair.in_ball);
      n["refused_by"].push_back(pair.refusers);
      if (fits(e_)) n["weight"].push_back(triple(weight_of(e_, pair)));
      if (spreads(e_)) n["given"].push_back(pair.given);
      if (!dims(e_)) continue;
      const ExplainedFirefly* firefly = firefly_at(e_, pair.vertex);
      n["kept"].push_back(firefly != nullptr ? firefly->kept : 1);
    }
    return n;
  }

  const Report& report_;
  const ExplainResult& e_;
};

}  // namespace

std::string json(const Report& report) {
  return core::json_text(JsonWriter(report).all());
}

}  // namespace psf::explain
