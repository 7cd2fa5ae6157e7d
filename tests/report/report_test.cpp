// The report's file: pictures survive it, texts cannot break out of it, and what is no study is
// refused.
#include "report/report.h"

#include <half.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "catch.h"
#include "core/error.h"
#include "report/report_picture.h"
#include "report/report_study.h"
#include "temp_folder.h"
#include "tools/command.h"
#include "tools/report_sample.h"

using namespace psf::tests;
using psf::Error;
using psf::ErrorCode;
using psf::report::encode_picture;
using psf::report::write_report;

namespace {

std::vector<std::uint8_t> bytes_of(const std::string& base64) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned buffer = 0, bits = 0;
  for (const char c : base64) {
    if (c == '=') break;
    buffer = buffer << 6 | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<std::uint8_t>(buffer >> bits & 0xff));
    }
  }
  return bytes;
}

// Planes of half floats, as the header of report_picture.h says it.
std::vector<std::uint16_t> halves_of(const std::string& base64, std::size_t width,
                                     std::size_t height) {
  const std::vector<std::uint8_t> packed = bytes_of(base64);
  const std::size_t count = 3 * width * height;
  std::vector<std::uint8_t> bytes(2 * count);
  uLongf size = bytes.size();
  REQUIRE(uncompress(bytes.data(), &size, packed.data(), packed.size()) == Z_OK);
  REQUIRE(size == bytes.size());
  std::vector<std::uint16_t> halves(count);
  for (std::size_t at = 0; at < count; ++at) {
    const std::size_t x = at % width, y = at / width % height;
    const unsigned before = x > 0 ? halves[at - 1] : y > 0 ? halves[at - width] : 0;
    halves[at] = static_cast<std::uint16_t>(before + bytes[at] + 256u * bytes[count + at]);
  }
  return halves;
}

// The page of some folders, and the data that it carries.
struct Page {
  std::string text;
  Json data;
  psf::report::ReportOutcome outcome;
};

Page page_of(const std::vector<std::string>& folders, std::size_t max_pictures = 24) {
  const TempFolder out;
  Page page;
  page.outcome = write_report(folders, out / "r.html", {max_pictures, "9.8.7"});
  page.text = read_text(out / "r.html");
  CHECK(page.outcome.bytes == page.text.size());
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = page.text.find(open) + open.size();
  page.data = Json::parse(page.text.substr(begin, page.text.find("</script>", begin) - begin));
  return page;
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size())
    ++count;
  return count;
}

// What is said of a folder that cannot be reported on.
std::string refusal(const std::string& folder, const std::string& page, ErrorCode code) {
  try {
    write_report(std::vector{folder}, page, {24, "1"});
  } catch (const Error& error) {
    CHECK(error.code() == code);
    return error.what();
  }
  return "nothing";
}

std::vector<std::string> ids_of(const Json& section) {
  std::vector<std::string> ids;
  for (const Json& picture : section.at("pictures")) ids.push_back(picture.at("id"));
  return ids;
}

}  // namespace

TEST_CASE("a picture comes back as the half floats nearest to it") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  psf::film::Image image;
  image.width = 5;
  image.height = 3;
  std::vector<float> values = {0, 1e-9f, 3e-8f, -2, 0.1f, 1e6f, -1e6f, 65504, kInfinity, NAN, 3};
  while (values.size() < 45) values.push_back(std::sin(static_cast<float>(values.size())));
  image.add("", "RGB", values);
  const auto encoded = encode_picture(image);
  CHECK(encoded.width == 5);
  CHECK(encoded.height == 3);
  const auto halves = halves_of(encoded.base64, 5, 3);
  for (std::size_t at = 0; at < values.size(); ++at) {
    const std::uint16_t bits = halves[at % 3 * 15 + at / 3];
    if (std::isnan(values[at])) {
      CHECK(Imath::half(Imath::half::FromBits, bits).isNan());
    } else {
      const float held =
          std::isinf(values[at]) ? values[at] : std::clamp(values[at], -65504.f, 65504.f);
      CHECK(bits == Imath::half(held).bits());
    }
  }
}

TEST_CASE("the page carries the studies, without the folders of files, and their pictures") {
  const TempFolder folder;
  const Json sweep = sample_sweep("room.json"), converge = sample_converge("room.json");
  write_sample(folder / "a", sweep);
  write_sample(folder / "b", converge);
  const Page page = page_of({folder / "a", folder / "b/"});
  CHECK(page.outcome.sections == 2);
  CHECK(page.data.at("version") == "9.8.7");
  CHECK(page.text.find("<title>room.json \u2013 room.pvb \u00b7 psf 9.8.7</title>") !=
        std::string::npos);
  CHECK(page.data["sections"][0]["folder"] == "a");
  CHECK(page.data["sections"][1]["folder"] == "b");
  CHECK(page.text.find("/somewhere") == std::string::npos);
  CHECK(page.text.find(folder.path().string()) == std::string::npos);
  Json expected = sweep;
  expected["input"]["file"] = "room.pvb";
  expected["reference"]["file"] = "truth.exr";
  CHECK(page.data["sections"][0]["study"] == expected);
  CHECK(page.data["sections"][1]["study"]["series"] == converge["series"]);

  // The picture of row 0003 is the reference times 1 + 3/16.
  std::size_t payload = 0;
  for (const Json& picture : page.data["sections"][0]["pictures"]) {
    if (picture["id"] == "0003") payload = picture["payload"];
  }
  const std::string open = "id=\"payload-" + std::to_string(payload) + "\">";
  const std::size_t begin = page.text.find(open) + open.size();
  const std::string base64 = page.text.substr(begin, page.text.find('<', begin) - begin);
  const auto halves = halves_of(base64, kSampleWidth, kSampleHeight);
  CHECK(halves[3 * kSampleWidth + 5] == Imath::half(8 * 1.1875f).bits());
}

TEST_CASE("a folder of folders stands for the studies in them") {
  const TempFolder folder;
  write_sample(folder / "all/b", sample_sweep("room.json"));
  write_sample(folder / "all/a", sample_converge("room.json"));
  std::filesystem::create_directories(folder / "all/c");
  const Page page = page_of({folder / "all"});
  REQUIRE(page.data["sections"].size() == 2);
  CHECK(page.data["sections"][0]["folder"] == "a");
  CHECK(page.data["sections"][1]["folder"] == "b");
}

TEST_CASE("equal pictures are embedded once") {
  const TempFolder folder;
  write_sample(folder / "a", sample_sweep("room.json"));
  write_sample(folder / "b", sample_sweep("room.json"));
  const Page page = page_of({folder / "a", folder / "b"});
  CHECK(page.outcome.pictures == 28);
  CHECK(occurrences(page.text, "id=\"payload-") == 14);
}

TEST_CASE("reference, unfiltered and the best come first, then the next best") {
  const TempFolder folder;
  Json sweep = sample_sweep("room.json");
  write_sample(folder / "a", sweep);
  const Page page = page_of({folder / "a"}, 5);
  CHECK(ids_of(page.data["sections"][0]) ==
        std::vector<std::string>{"reference", "unfiltered", "0006", "0008", "0005"});
  CHECK(page.data["sections"][0]["left_out"] == 9);
  CHECK(page.outcome.pictures_left_out == 9);
  CHECK(page_of({folder / "a"}, 0).outcome.pictures == 0);

  // By a metric that is better where it is more, the same rows: PSNR falls with the error.
  std::swap(sweep["metrics"][0], sweep["metrics"][1]);
  write_sample(folder / "b", sweep);
  CHECK(ids_of(page_of({folder / "b"}, 3).data["sections"][0]).back() == "0006");

  write_sample(folder / "c", sample_converge("room.json"));
  const Json pictures = page_of({folder / "c"}).data["sections"][0]["pictures"];
  std::vector<std::string> order;
  for (const Json& picture : pictures) {
    order.push_back(picture["id"].get<std::string>() +
                    (picture["point"].is_null() ? "" : "@" + picture["point"].dump()));
  }
  CHECK(std::vector(order.begin(), order.begin() + 6) ==
        std::vector<std::string>{"reference", "unfiltered@3", "0001@3", "0002@3", "0001@2",
                                 "0002@2"});
}

TEST_CASE("no text of a study ends its script or writes elements") {
  const TempFolder folder;
  const std::string hostile = "</script><script>alert(1)</script><!-- & \" '";
  Json sweep = sample_sweep(hostile);
  sweep["input"]["camera"] = hostile;
  sweep["rows"][0]["parameters"]["r0"] = hostile;
  sweep["rows"][1]["parameters"][hostile] = hostile;
  write_sample(folder / "<a>", sweep);
  const Page page = page_of({folder / "<a>"});
  CHECK(page.text.find("alert(1)</script>") == std::string::npos);
  CHECK(page.text.find("<script>alert") == std::string::npos);
  CHECK(page.data["sections"][0]["study"]["input"]["scene"] == hostile);
  CHECK(page.text.find("<h1>&lt;/script&gt;&lt;script&gt;alert(1)") != std::string::npos);
}

TEST_CASE("the same folders give the same bytes") {
  const TempFolder folder;
  write_sample(folder / "a", sample_sweep("room.json"));
  CHECK(page_of({folder / "a"}).text == page_of({folder / "a"}).text);
}

TEST_CASE("what is no study is refused with file, place and remedy, and writes nothing") {
  struct Fault {
    std::string kind, place, expected;
    Json value;
  };
  const std::vector<Fault> faults = {
      {"sweep", "/kind", "\"sweep\"", "converge"},
      {"sweep", "/format", "1, what this version of psf reads", 2},
      {"sweep", "/metrics", "a list", Json::object()},
      {"sweep", "/metrics", "at least one metric", Json::array()},
      {"sweep", "/metrics/1/name", "a text", 3},
      {"sweep", "/input", "an object", "room.pvb"},
      {"sweep", "/input/scene", "a text", nullptr},
      {"sweep", "/unfiltered/metrics/relMSE", "a number or null", "small"},
      {"sweep", "/rows", "at least one row", Json::array()},
      {"sweep", "/rows/3/id", "an id that no other has", "0001"},
      {"sweep", "/rows/3/parameters/r0", "a text", 8},
      {"sweep", "/rows/3/metrics", "an object", 0.1},
      {"sweep", "/rows/3/picture", "a file name in this folder", "../secret.exr"},
      {"sweep", "/rows/3/picture", "a file name in this folder", "/etc/secret.exr"},
      {"sweep", "/rows/3/picture", "a text", 7},
      {"converge", "/inputs", "at least one dump", Json::array()},
      {"converge", "/n/2", "numbers that rise", 2},
      {"converge", "/series", "at least one series", Json::array()},
      {"converge", "/series/1/points", "4 points, one an n", Json::array()},
      {"converge", "/series/1/points/2/n", "4", 5},
      {"converge", "/series/1/points/2/bias_sq", "a number or null", "little"},
      {"converge", "/series/1/points/2/bias_sq_ci", "two numbers or null", Json({1})},
      {"converge", "/series/1/points/2/slope", "an object", 1},
      {"converge", "/series/1/points/2/seconds/dump", "a number or null", "1s"},
      {"converge", "/speedups/0/equal_time", "a number or null", "2x"},
      {"sweep", "/rows/3/neighbors", "a number or null", "many"},
      {"sweep", "/rows/3/radius", "an object", 8},
  };
  for (const Fault& fault : faults) {
    const TempFolder folder;
    const std::string dir = folder / "d", file = dir + "/" + fault.kind + ".json";
    Json study = fault.kind == "sweep" ? sample_sweep("room.json") : sample_converge("room.json");
    study[Json::json_pointer(fault.place)] = fault.value;
    std::filesystem::create_directories(dir);
    std::ofstream(file) << study.dump();
    INFO(fault.place << " = " << fault.value.dump());
    CHECK(refusal(dir, folder / "r.html", ErrorCode::bad_input) ==
          file + ": " + fault.place + ": expected " + fault.expected + "; write it anew with psf " +
              fault.kind + " -o " + dir);
    CHECK(folder.file_count() == 1);
  }
  const TempFolder folder;
  std::filesystem::create_directories(folder / "d");
  std::ofstream(folder / "d/sweep.json") << "{\"kind\": ";
  CHECK(refusal(folder / "d", folder / "r.html", ErrorCode::bad_input)
            .starts_with(folder / "d/sweep.json: is no JSON at byte "));
}

TEST_CASE("a missing folder, study or picture is named") {
  const TempFolder folder;
  const auto message = [&](const std::string& name) {
    return refusal(folder / name, folder / "r.html", ErrorCode::io);
  };
  CHECK(message("none") == folder / "none" + ": is no folder");
  std::filesystem::create_directories(folder / "empty");
  CHECK(message("empty").find("has no sweep.json, converge.json or ablate.json") !=
        std::string::npos);
  write_sample(folder / "a", sample_sweep("room.json"));
  std::filesystem::remove(folder / "a/0006.exr");
  CHECK(message("a").starts_with(folder / "a/0006.exr: no such picture"));
  CHECK(!std::filesystem::exists(folder / "r.html"));
}

TEST_CASE("the pictures of an ablation keep the order of its rows, and it needs no reference") {
  const TempFolder folder;
  Json ablate = sample_ablate("room.json");
  write_sample(folder / "parts", ablate);
  const Page page = page_of({folder / "parts"});
  CHECK(ids_of(page.data.at("sections").at(0)) ==
        std::vector<std::string>{"reference", "0001", "0002", "0003", "0004", "0005", "0006",
                                 "0007", "0008"});
  ablate["reference"] = nullptr;
  ablate["metrics"] = Json::array();
  for (Json& row : ablate["rows"]) row["metrics"] = Json::object();
  write_json(folder / "parts", ablate);
  CHECK(ids_of(page_of({folder / "parts"}).data.at("sections").at(0)).front() == "0001");
  ablate["rows"][3].erase("label");
  write_json(folder / "parts", ablate);
  CHECK(refusal(folder / "parts", folder / "r.html", ErrorCode::bad_input) ==
        folder / "parts/ablate.json: /rows/3: expected \"label\" in it; write it anew with psf "
                 "ablate -o " +
            folder / "parts");
}
