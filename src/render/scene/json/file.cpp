#include "render/scene/json/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "render/scene/whole_file.h"

namespace psf::render {
namespace {

using Json = nlohmann::json;

constexpr int kMaxValueDepth = 512;  // deepest nesting of values

// "3:17", both from 1, of the byte at `offset`.
std::string line_and_column(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 = 0
  return fmt::format("{}:{}", line, before.size() - line_start + 1);
}

// "syntax error while parsing value - unexpected '}'" of nlohmann's longer message.
std::string reason(const std::string& what) {
  std::size_t begin = what.find("] ");
  begin = begin == std::string::npos ? 0 : begin + 2;
  const std::size_t column = what.find("column", begin);
  if (column != std::string::npos && what.find(": ", column) != std::string::npos) {
    begin = what.find(": ", column) + 2;
  }
  return what.substr(begin);
}

}  // namespace

Json read_json(const std::string& path) {
  return parse_json(read_whole<std::string>(path), path);
}

Json parse_json(std::string text, const std::string& path) {
  std::istringstream in(std::move(text));
  const auto fail = [&](std::size_t offset, const std::string& what) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}:{}: {}", path, line_and_column(in.view(), offset), what));
  };
  // The offset of the character that was read last.
  const auto offset = [&in] {
    const std::streamoff now = in.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in);
    return static_cast<std::size_t>(std::max<std::streamoff>(now, 1) - 1);
  };
  std::vector<std::set<std::string>> keys;  // keys so far of the objects around the current place
  const auto watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kMaxValueDepth) {
      fail(offset(), fmt::format("more than {} values within values", kMaxValueDepth));
    }
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key) {
      const auto key = parsed.get<std::string>();
      if (!keys.back().insert(key).second)
        fail(offset(), fmt::format("the key \"{}\" is twice in one object", key));
    }
    return true;
  };
  try {
    return Json::parse(in, watch);
  } catch (const Json::parse_error& error) {
    fail(error.byte == 0 ? 0 : error.byte - 1, "malformed JSON: " + reason(error.what()));
  } catch (const Json::exception& error) {
    // A number out of range has no place, but its text is in the message, in quotes.
    const std::string what = reason(error.what());
    const std::size_t begin = what.find('\'') + 1, end = what.rfind('\'');
    const bool quoted = begin > 0 && end > begin;
    fail(quoted ? in.view().find(what.substr(begin, end - begin)) : 0, "malformed JSON: " + what);
  }
  return {};
}

std::size_t line_of(const std::string& file, const std::string& path) {
  struct Around {
    std::string path;
    bool is_array;
    std::size_t items = 0;
  };
  std::ifstream in(file, std::ios::binary);
  std::vector<Around> around;
  std::string key;
  std::streamoff end = 0;
  const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
    using Event = Json::parse_event_t;
    if (event == Event::key) {
      key = parsed.get<std::string>();
    } else if (event == Event::object_end || event == Event::array_end) {
      around.pop_back();
    } else {
      std::string place;
      if (!around.empty()) {
        Around& a = around.back();
        place = fmt::format("{}/{}", a.path, a.is_array ? std::to_string(a.items++) : key);
      }
      if (place == path) {
        // What ends a number is read with it.
        end = in.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in);
        if (parsed.is_number()) --end;
      }
      if (event != Event::value) around.push_back({std::move(place), event == Event::array_start});
    }
    return event != Event::value;  // nothing is kept
  };
  if (Json::parse(in, watch, false).is_discarded()) return 0;
  in.clear();
  in.seekg(0);
  std::size_t lines = 1;
  for (std::streamoff k = 0; k < end; ++k) lines += in.get() == '\n' ? 1u : 0u;
  return lines;
}

}  // namespace psf::render
