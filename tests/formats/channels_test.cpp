// The table of channels is that of the specification, of the header for C and of the Python module.
#include "formats/layout/channels.h"

#include <fmt/format.h>

#include <regex>
#include <sstream>

#include "catch.h"
#include "read_text.h"

namespace {

using psf::formats::kChannels;

// Type and components as the specification writes them: "f32 x 3".
std::string type_text(const psf::formats::ChannelInfo& channel) {
  const std::string type(name_of(channel.type));
  return channel.components == 1 ? type : fmt::format("{} x {}", type, channel.components);
}

std::string source(const char* path) {
  return psf::tests::read_text(std::string(PSF_SOURCE_DIR) + path);
}

}  // namespace

TEST_CASE("the specification has a row for each channel, in this order, and for no other") {
  std::istringstream text(source("/formats/README.md"));
  const std::regex row("^\\| `([a-z_]+)` \\| ([a-z0-9 ]+) \\| (R?) ?\\| (.*) \\|$");
  std::size_t k = 0;
  bool inside = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("## ")) inside = line == "## Channels";
    std::smatch match;
    if (!inside || !std::regex_match(line, match, row)) continue;
    REQUIRE(k < kChannels.size());
    INFO(line);
    CHECK(match[1].str() == kChannels[k].name);
    CHECK(match[2].str() == type_text(kChannels[k]));
    CHECK((match[3] == "R") == kChannels[k].required);
    const std::string meaning = match[4];
    // The row of hit_distance and of roughness says what they are without their symbol.
    const std::string symbol(kChannels[k].symbol);
    const bool is_said = symbol.empty() || symbol == "h_i" || symbol == "q_i";
    CHECK((is_said || meaning.find(symbol) != std::string::npos));
    ++k;
  }
  CHECK(k == kChannels.size());
}

TEST_CASE("pvb.h and pvb.py have every channel with its type") {
  const std::string header = source("/formats/pvb.h"), module = source("/formats/pvb.py");
  for (const psf::formats::ChannelInfo& channel : kChannels) {
    INFO(channel.name);
    std::string type(name_of(channel.type)), upper(type);
    for (char& c : upper) c = static_cast<char>(std::toupper(c));
    CHECK(header.find(fmt::format("{{\"{}\", PVB_{}, {}, PVB_PLAIN}}", channel.name, upper,
                                  channel.components)) != std::string::npos);
    const std::string components =
        channel.components == 1 ? "" : fmt::format(", {}", channel.components);
    CHECK(module.find(fmt::format("Channel(\"{}\", \"{}\"{})", channel.name, type, components)) !=
          std::string::npos);
  }
}

TEST_CASE("a name that means nothing has no row") {
  CHECK(psf::formats::channel_info("mine.temperature") == nullptr);
  CHECK(psf::formats::channel_info("") == nullptr);
  CHECK(psf::formats::channel_info("roughness")->components == 1);
}
