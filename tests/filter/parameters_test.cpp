// Parameters as text and their limits.
#include <limits>

#include "catch.h"
#include "core/error.h"
#include "filter/parameters_text.h"

namespace psf {
namespace {

using filter::BlockSize;
using filter::Parameters;
using filter::Radius;
using filter::RadiusBasis;

TEST_CASE("A radius is read with its basis and written back") {
  for (const auto& [text, r0, basis] : {std::tuple{"0.02", 0.02, RadiusBasis::distance},
                                        std::tuple{"8px", 8.0, RadiusBasis::footprint},
                                        std::tuple{"0.5wu", 0.5, RadiusBasis::world},
                                        std::tuple{"1e-3wu", 1e-3, RadiusBasis::world},
                                        std::tuple{"0", 0.0, RadiusBasis::distance}}) {
    Radius radius;
    filter::parse_radius(text, radius);
    CHECK(radius.r0 == r0);
    CHECK(radius.basis == basis);
    Radius again;
    filter::parse_radius(filter::to_text(radius), again);
    CHECK(again.r0 == r0);
    CHECK(again.basis == basis);
  }
  Radius radius;
  for (const char* text : {"", "px", "8 px", "8pix", "-1", "nan", "0.02x", "wu", "0x2"}) {
    INFO(text);
    CHECK_THROWS_AS(filter::parse_radius(text, radius), Error);
  }
}

TEST_CASE("A block is read and written back") {
  for (const char* text : {"2^16", "3^10", "1pass", "16passes", "all", "7^0"}) {
    CHECK(filter::to_text(filter::parse_block(text)) == text);
  }
  CHECK(filter::parse_block("16pass").passes == 16);
  for (const char* text :
       {"", "2", "1^4", "2^", "^4", "2^64", "0passes", "passes", "-1pass", "All", "2^-1"}) {
    INFO(text);
    CHECK_THROWS_AS(filter::parse_block(text), Error);
  }
}

TEST_CASE("A share of sources and a threshold are read") {
  CHECK(filter::parse_sources("1/4") == 4);
  CHECK(filter::parse_sources("1") == 1);
  for (const char* text : {"", "4", "1/0", "2/3", "1/", "0.25"}) {
    INFO(text);
    CHECK_THROWS_AS(filter::parse_sources(text), Error);
  }
  CHECK(filter::parse_threshold("0.5", "--normal") == 0.5f);
  CHECK_FALSE(filter::parse_threshold("off", "--normal").has_value());
  CHECK_THROWS_WITH(filter::parse_threshold("on", "--normal"),
                    "--normal: 'on' is neither a number nor off");
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
  CHECK(all ==
        "r0=8px delta=0.3333333333333333 radius-count=samples block=4passes normal=0.95 "
        "reflectance=0.05 "
        "visibility=on hit-distance=off plane=off direction=off material=off gloss=0.8 "
        "demodulate=off "
        "iterations=1 "
        "sources=1/4 estimator=average agree=off search=flann ");
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
  CHECK(needs[0].wanted_by == "--plane");
  CHECK(needs[1].channel == "reflectance");
  CHECK(needs[1].wanted_by == "--demodulate");
}

}  // namespace
}  // namespace psf
