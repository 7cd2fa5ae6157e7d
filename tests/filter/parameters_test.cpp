// Parameters as text and their limits.
#include <array>
#include <limits>
#include <map>
#include <string>

#include "catch.h"
#include "core/error.h"
#include "filter/parameters/text.h"
#include "filter/parameters/values.h"

namespace psf {
namespace {

using filter::BlockSize;
using filter::Parameters;
using filter::Radius;
using filter::RadiusBasis;

Parameters with(const char* name, const std::string& text) {
  Parameters parameters;
  filter::set_parameter(parameters, name, text);
  return parameters;
}

TEST_CASE("A radius is read with its basis and written back") {
  for (const auto& [text, r0, basis] : {std::tuple{"0.02", 0.02, RadiusBasis::distance},
                                        std::tuple{"8px", 8.0, RadiusBasis::footprint},
                                        std::tuple{"0.5wu", 0.5, RadiusBasis::world},
                                        std::tuple{"1e-3wu", 1e-3, RadiusBasis::world},
                                        std::tuple{"0", 0.0, RadiusBasis::distance}}) {
    const Radius radius = with("r0", text).radius;
    CHECK(radius.r0 == r0);
    CHECK(radius.basis == basis);
    const Radius again = with("r0", filter::to_text(radius)).radius;
    CHECK(again.r0 == r0);
    CHECK(again.basis == basis);
  }
  for (const char* text : {"", "px", "8 px", "8pix", "-1", "nan", "0.02x", "wu", "0x2"}) {
    INFO(text);
    CHECK_THROWS_AS(with("r0", text), Error);
  }
}

TEST_CASE("A block is read and written back") {
  for (const char* text : {"2^16", "3^10", "1pass", "16passes", "all", "7^0"}) {
    CHECK(filter::to_text(with("block", text).block) == text);
  }
  CHECK(with("block", "16pass").block.passes == 16);
  for (const char* text :
       {"", "2", "1^4", "2^", "^4", "2^64", "0passes", "passes", "-1pass", "All", "2^-1"}) {
    INFO(text);
    CHECK_THROWS_AS(with("block", text), Error);
  }
}

TEST_CASE("A share of sources and a threshold are read") {
  CHECK(with("sources", "1/4").sources == 4);
  CHECK(with("sources", "1").sources == 1);
  for (const char* text : {"", "4", "1/0", "2/3", "1/", "0.25"}) {
    INFO(text);
    CHECK_THROWS_AS(with("sources", text), Error);
  }
  CHECK(with("normal", "0.5").weights.normal == 0.5f);
  CHECK_FALSE(with("normal", "off").weights.normal.has_value());
  CHECK_THROWS_WITH(with("normal", "on"), "`normal`: 'on' is neither a number nor off");
}

TEST_CASE("Every parameter is read from the text that it has, and says what else it may be") {
  // Two values each; the second is no default.
  const std::map<std::string, std::array<const char*, 2>> texts = {
      {"r0", {"8px", "0.02"}},
      {"delta", {"0", "0.25"}},
      {"radius-count", {"samples", "blocks"}},
      {"block", {"4passes", "2^16"}},
      {"normal", {"0.95", "off"}},
      {"reflectance", {"0.05", "off"}},
      {"visibility", {"on", "off"}},
      {"hit-distance", {"off", "0.1"}},
      {"plane", {"off", "1"}},
      {"direction", {"off", "0.5"}},
      {"material", {"off", "on"}},
      {"gloss", {"0.8", "off"}},
      {"demodulate", {"off", "on"}},
      {"iterations", {"1", "2"}},
      {"sources", {"1/1", "1/4"}},
      {"estimator", {"average", "adaptive"}},
      {"agree", {"1.5", "2.5"}},
      {"fit", {"mean", "linear"}},
      {"fireflies", {"keep", "clamp:4"}},
      {"pixels", {"keep", "regress"}},
      {"search", {"flann", "brute"}}};
  REQUIRE(filter::parameter_table().size() == texts.size());
  for (const filter::Parameter& parameter : filter::parameter_table()) {
    INFO(parameter.name);
    Parameters parameters;
    parameters.estimator = filter::Estimator::adaptive;  // with it, every parameter means something
    for (const char* text : texts.at(parameter.name)) {
      parameter.set(parameters, text);
      CHECK(parameter.text(parameters) == text);
    }
    CHECK(parameter.text(Parameters()) != texts.at(parameter.name)[1]);
    CHECK_THROWS_WITH(
        parameter.set(parameters, "x"),
        Catch::Matchers::StartsWith(std::string("`") + parameter.name + "`: 'x' is "));
  }
  CHECK_THROWS_WITH(
      with("radius", "8px"),
      Catch::Matchers::StartsWith("there is no parameter 'radius'; there are r0, delta"));
}

TEST_CASE("Defaults are valid, what is out of range is refused") {
  CHECK_NOTHROW(Parameters().validate());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto refused = [](auto change) {
    Parameters parameters;
    change(parameters);
    CHECK_THROWS_AS(parameters.validate(), Error);
  };
  refused([](Parameters& p) { p.radius.r0 = -1; });
  refused([](Parameters& p) { p.radius.r0 = std::numeric_limits<double>::infinity(); });
  refused([](Parameters& p) { p.radius.delta = 1; });
  refused([](Parameters& p) { p.radius.delta = -0.1; });
  refused([](Parameters& p) { p.block.base = 1; });
  refused([](Parameters& p) { p.block.passes = 0; });
  refused([](Parameters& p) { p.weights.normal = 1.5f; });
  refused([nan](Parameters& p) { p.weights.normal = nan; });
  refused([](Parameters& p) { p.weights.reflectance = -0.1f; });
  refused([](Parameters& p) { p.weights.hit_distance = -1.0f; });
  refused([](Parameters& p) { p.weights.plane = -1.0f; });
  refused([](Parameters& p) { p.weights.direction = -2.0f; });
  refused([](Parameters& p) { p.weights.gloss = 0.0f; });
  refused([nan](Parameters& p) { p.weights.gloss = nan; });
  refused([](Parameters& p) { p.iterations = 0; });
  refused([](Parameters& p) { p.sources = 0; });
}

TEST_CASE("Every parameter is described, under the name of its option") {
  Parameters parameters;
  parameters.weights.visibility = true;
  parameters.sources = 4;
  std::string all;
  for (const auto& [name, value] : filter::describe(parameters)) all += name + "=" + value + " ";
  CHECK(
      all ==
      "r0=8px delta=0.3333333333333333 radius-count=samples block=4passes normal=0.95 "
      "reflectance=0.05 "
      "visibility=on hit-distance=off plane=off direction=off material=off gloss=0.8 "
      "demodulate=off "
      "iterations=1 "
      "sources=1/4 estimator=average agree=off fit=mean fireflies=keep pixels=keep search=flann ");
}

TEST_CASE("Channels are asked for by the parameters that use them") {
  Parameters parameters;
  parameters.weights = filter::WeightTerms::none();
  CHECK(filter::optional_channels(parameters).empty());
  parameters.weights.plane = 1.0f;
  parameters.demodulate = true;
  const auto needs = filter::optional_channels(parameters);
  REQUIRE(needs.size() == 2);
  CHECK(needs[0].channel == "normal");
  CHECK(needs[0].wanted_by == "`plane`");
  CHECK(needs[1].channel == "reflectance");
  CHECK(needs[1].wanted_by == "`demodulate`");
}

}  // namespace
}  // namespace psf
