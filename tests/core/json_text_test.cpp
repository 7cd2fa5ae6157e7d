// Names are bytes, JSON is UTF-8: whatever a string holds, text comes out.
#include "core/json_text.h"

#include <nlohmann/json.hpp>

#include "catch.h"

TEST_CASE("bytes that are no UTF-8 become U+FFFD, all else stays") {
  using Json = nlohmann::ordered_json;
  for (const auto& [bytes, text] :
       {std::pair<std::string, std::string>{"caf\xe9.pvb", "caf\xEF\xBF\xBD.pvb"},
        {"caf\xc3\xa9.pvb", "caf\xc3\xa9.pvb"},
        {"\xff", "\xEF\xBF\xBD"},
        {"cut \xe2\x82", "cut \xEF\xBF\xBD"},
        {"", ""}}) {
    const std::string json = psf::core::json_text(Json{{bytes, {bytes, 1}}});
    const Json back = Json::parse(json);
    CHECK(back[text][0] == text);
    CHECK(json.find('\n') == std::string::npos);
  }
}
