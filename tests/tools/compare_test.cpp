// psf compare as a user meets it.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catch.h"
#include "command.h"
#include "film/image.h"

using psf::tests::Outcome;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

psf::film::Image grey(std::size_t width, float value) {
  psf::film::Image image;
  image.width = width;
  image.height = 2;
  image.add("", "RGB", std::vector<float>(width * 2 * 3, value));
  return image;
}

void write_grey(const std::string& path, std::size_t width, float value) {
  psf::film::write_exr(path, grey(width, value));
}

// Grey of 1, but for the pixel 0, 0 of another value, in all channels.
void write_spotted(const std::string& path, float spot) {
  psf::film::Image image = grey(4, 1);
  for (psf::film::Layer& layer : image.layers) layer.values[0] = spot;
  psf::film::write_exr(path, image);
}

std::vector<unsigned char> read_png(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  REQUIRE(input);
  const OIIO::ImageSpec& spec = input->spec();
  REQUIRE(spec.nchannels == 3);
  std::vector<unsigned char> bytes(static_cast<std::size_t>(spec.width * spec.height * 3));
  REQUIRE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
  return bytes;
}

}  // namespace

TEST_CASE("compare prints every metric and what it depends on") {
  const TempFolder folder;
  write_grey(folder / "a.exr", 4, 1.5f);
  write_grey(folder / "b.exr", 4, 1);
  const std::string command = "psf compare " + (folder / "a.exr") + " " + (folder / "b.exr");
  const Outcome outcome = run(command);
  CHECK(outcome.code == 0);
  CHECK(outcome.err.empty());
  const std::string first =
      "relMSE 0.247525   (epsilon 0.01)\nMSE    0.25\nSMAPE  0.199203   (epsilon 0.01)\n"
      "MAPE   0.49505    (epsilon 0.01)\nPSNR   6.02 dB    (peak 1)\nSSIM   ";
  CHECK(outcome.out.substr(0, first.size()) == first);
  CHECK(outcome.out.find("(tone-mapped sRGB, exposure 0)") != std::string::npos);
  CHECK(outcome.out.find("(tone-mapped, exposure 0, 67.02 pixels per degree)") !=
        std::string::npos);
  CHECK(run(command + " --metric flip").out.starts_with("FLIP "));
  CHECK(run(command + " --epsilon 1").out.starts_with("relMSE 0.125 "));
}

TEST_CASE("A metric becomes an exit code by --max and --min") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr";
  write_grey(a, 4, 1.5f);
  write_grey(b, 4, 1);
  const std::string command = "psf compare " + a + " " + b;
  CHECK(run(command + " --max 0.25").code == 0);
  const Outcome above = run(command + " --max 0.2");
  CHECK(above.code == 1);
  CHECK(above.err == "psf: " + a + ": relMSE 0.247525 is above 0.2\n");
  CHECK(above.out.starts_with("relMSE 0.247525"));
  CHECK(run(command + " --metric mse --max 0.26").code == 0);
  CHECK(run(command + " --metric mse --max 0.249").code == 1);
  CHECK(run(command + " --metric psnr --min 6").code == 0);
  const Outcome below = run(command + " --metric psnr --min 6.1");
  CHECK(below.code == 1);
  CHECK(below.err == "psf: " + a + ": PSNR 6.02 dB is below 6.1\n");
  const Outcome wrong = run(command + " --metric ssim --max 0.9");
  CHECK(wrong.code == 2);
  CHECK(wrong.err == "psf: SSIM is better when higher, bound it with --min\n");
  CHECK(run(command + " --min 0.1").code == 2);
}

TEST_CASE("pixels that are not finite are left out and told, and no bound holds with them") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr";
  write_spotted(a, NAN);
  write_grey(b, 4, 1);
  const std::string command = "psf compare " + a + " " + b;
  const Outcome outcome = run(command);
  CHECK(outcome.code == 0);
  CHECK(outcome.out.starts_with("relMSE 0 "));
  CHECK(outcome.out.find("left out: 1 pixel not finite in " + a + " or " + b) != std::string::npos);
  const Outcome bound = run(command + " --max 1");
  CHECK(bound.code == 1);
  CHECK(bound.err ==
        "psf: " + a + ": no bound holds: 1 pixel is not finite here or in " + b + "\n");
  // Nor where nothing is left.
  write_grey(a, 4, NAN);
  CHECK(run(command + " --max 1").code == 1);
  CHECK(run(command).out.starts_with("relMSE nan"));
}

TEST_CASE("regions are a row each and the bound is for each; trimming says how many") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr", json = folder / "j.json";
  write_spotted(a, 3);
  write_grey(b, 4, 1);
  const std::string command = "psf compare " + a + " " + b + " --metric mse";
  const Outcome rows = run(command + " --region 0,0,1x2 --region 1,0,3x2 --json " + json);
  CHECK(rows.code == 0);
  CHECK(rows.out.find("\n0,0,1x2                     2 ") != std::string::npos);
  CHECK(rows.out.find("\n1,0,3x2                     0 ") != std::string::npos);
  const auto figures = nlohmann::json::parse(psf::tests::read_text(json));
  REQUIRE(figures["rows"].size() == 2);
  CHECK(figures["rows"][0]["region"] == "0,0,1x2");
  CHECK(figures["rows"][0]["pixels"] == 2);
  CHECK(figures["rows"][0]["metrics"]["MSE"] == 2.0);
  CHECK(figures["rows"][1]["metrics"]["MSE"] == 0.0);
  CHECK(figures["rows"][1]["metrics"]["PSNR"].is_null());  // infinite
  CHECK(figures["metrics"][0]["name"] == "MSE");
  CHECK(run(command + " --max 1").code == 0);  // 0.5 over all
  const Outcome bound = run(command + " --max 1 --region 1,0,3x2 --region 0,0,1x2");
  CHECK(bound.code == 1);
  CHECK(bound.err == "psf: " + a + ": MSE 2 is above 1 in 0,0,1x2\n");

  for (const std::string trim : {"12.5%", "0.125"}) {
    const Outcome trimmed = run(command + " --max 0 --trim " + trim);
    CHECK(trimmed.code == 0);
    CHECK(trimmed.out.find("left out of each metric: the 1 pixel of the largest error, of 8") !=
          std::string::npos);
  }
}

TEST_CASE("error pictures hold the metric of every pixel, as values or colours of a scale") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr";
  psf::film::Image image = grey(4, 1);
  for (psf::film::Layer& layer : image.layers) {
    layer.values[1] = 3;  // an error of 4
    layer.values[2] = 2;  // an error of 1
    layer.values[7] = NAN;
  }
  psf::film::write_exr(a, image);
  write_grey(b, 4, 1);
  const std::string values = folder / "e.exr", colors = folder / "e.png";
  const Outcome outcome = run("psf compare " + a + " " + b + " --metric mse --error " + values +
                              " --error " + colors + " --error-max 2 --colors viridis");
  CHECK(outcome.code == 0);
  CHECK(outcome.out.find(colors + ": MSE in viridis from 0 to 2, 1 pixel above\n") !=
        std::string::npos);
  const std::vector<float> written = *psf::film::read_exr(values).find("Y");
  CHECK(written[0] == 0);
  CHECK(written[1] == 4);
  CHECK(written[2] == 1);
  CHECK(std::isnan(written[7]));
  const std::vector<unsigned char> bytes = read_png(colors);
  const auto color = [&](std::size_t pixel) {
    return std::vector<int>(bytes.begin() + static_cast<std::ptrdiff_t>(3 * pixel),
                            bytes.begin() + static_cast<std::ptrdiff_t>(3 * pixel + 3));
  };
  // The ends and the middle of viridis as it is published.
  const auto is = [&](std::size_t pixel, const std::vector<int>& expected) {
    for (std::size_t k = 0; k < 3; ++k) {
      INFO("pixel " << pixel << " channel " << k);
      CHECK(std::abs(color(pixel)[k] - expected[k]) <= 3);
    }
  };
  is(0, {68, 1, 84});
  is(1, {253, 231, 37});
  is(2, {33, 145, 140});
  CHECK(color(7) == std::vector<int>{0, 255, 255});
}

TEST_CASE("A layer of the picture is compared by --layer, with or without its dot") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr";
  psf::film::Image image = grey(4, 1.5f);
  image.add("unfiltered-input.", "RGB", std::vector<float>(4 * 2 * 3, 1.0f));
  psf::film::write_exr(a, image);
  write_grey(b, 4, 1);
  const std::string command = "psf compare " + a + " " + b;
  CHECK(run(command + " --layer unfiltered-input --max 0").code == 0);
  CHECK(run(command + " --layer unfiltered-input. --max 0").code == 0);
  CHECK(run(command + " --max 0").code == 1);
}

TEST_CASE("layers of other programs' pictures are found, or listed and named") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr", c = folder / "c.exr";
  const auto write = [](const std::string& path, const std::vector<std::string>& layers) {
    psf::film::Image image;
    image.width = 4;
    image.height = 2;
    float value = 1;
    for (const std::string& layer : layers) {
      image.add(layer, "RGB", std::vector<float>(4 * 2 * 3, value));
      value *= 2;
    }
    psf::film::write_exr(path, image);
  };
  write(a, {"ViewLayer.Combined."});
  write(b, {"beauty.", "diffuse."});
  write_grey(c, 4, 2);
  const Outcome found = run("psf compare " + a + " " + c + " --metric mse");
  CHECK(found.code == 0);
  CHECK(found.out.starts_with("MSE    1\n"));
  CHECK(found.err ==
        "note: " + a + ": has no colours at its root, its layer ViewLayer.Combined is taken\n");
  CHECK(run("psf compare --quiet " + a + " " + c).err.empty());
  const Outcome several = run("psf compare " + a + " " + b);
  CHECK(several.code == 2);
  CHECK(several.err == "psf: " + b +
                           ": has several layers that would do; give --reference-layer one of: "
                           "beauty, diffuse\n");
  CHECK(run("psf compare " + a + " " + b + " --reference-layer beauty --max 0").code == 0);
  CHECK(run("psf compare " + b + " " + c + " --layer diffuse --max 0").code == 0);
  CHECK(run("psf compare " + b + " " + b + " --layer beauty --reference-layer diffuse --max 0")
            .code == 1);
  // The layer of the reference has the same name, unless another is given.
  CHECK(run("psf compare " + b + " " + b + " --layer diffuse --max 0").code == 0);
}

TEST_CASE("pictures are compared where their pixels lie") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr", c = folder / "c.exr";
  const auto write = [](const std::string& path, int x) {
    OIIO::ImageSpec spec(8, 4, 3, OIIO::TypeDesc::FLOAT);
    spec.x = x;
    spec.full_width = 12;
    spec.full_height = 4;
    const std::vector<float> values(8 * 4 * 3, 1.0f);
    const auto output = OIIO::ImageOutput::create(path);
    REQUIRE(output);
    REQUIRE(output->open(path, spec));
    REQUIRE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
    REQUIRE(output->close());
  };
  write(a, 0);
  write(b, 4);
  const std::string command = "psf compare " + a + " " + b + " --metric mse";
  const Outcome apart = run(command + " --max 0");
  CHECK(apart.code == 1);
  // The third of each where it has no pixels is black.
  CHECK(apart.out.starts_with("MSE    0.666667\n"));
  CHECK(apart.err.find("note: " + a + ": has the pixels 0,0,8x4 of a picture 0,0,12x4") == 0);
  CHECK(run(command + " --region 4,0,4x4 --max 0").code == 0);
  CHECK(run(command + " --region 0,0,4x4 --max 0").code == 1);
  write_grey(c, 8, 1);
  CHECK(run("psf compare " + a + " " + c).code == 3);
}

TEST_CASE("compare tells wrong input in one line with the right code") {
  const TempFolder folder;
  const std::string a = folder / "a.exr", b = folder / "b.exr";
  write_grey(a, 4, 1);
  write_grey(b, 5, 1);
  const Outcome size = run("psf compare " + a + " " + b);
  CHECK(size.code == 3);
  CHECK(size.err == "psf: " + a + ": is 4x2, but " + b + " is 5x2; compare pictures of one size\n");
  CHECK(run("psf compare " + a + " nowhere.exr").code == 4);
  const Outcome layer = run("psf compare " + a + " " + a + " --layer albedo");
  CHECK(layer.code == 3);
  CHECK(layer.err == "psf: " + a + ": has no layer albedo; its layers: (without a name)\n");
  const std::vector<std::pair<std::string, std::string>> mistakes = {
      {"--maximum 1", "--maximum"},   {"--metric lpips", "one of relMSE"},
      {"--region 0,0,5x1", "is 4x2"}, {"--region 0,0,0x1", "is empty"},
      {"--region 4,4", "X,Y,WxH"},    {"--region=-1,0,1x1", "X,Y,WxH"},
      {"--trim 100%", "--trim 100%"}, {"--trim=-1%", "--trim -1%"},
      {"--trim x", "write 0.1%"},     {"--trim 5%%", "write 0.1%"},
      {"--epsilon 0", "--epsilon"},   {"--ppd 0", "--ppd"},
      {"--exposure nan", "exposure"}, {"--error e.jpg", "use .exr or .png"},
      {"--colors jet", "--colors"},   {"--error-max 0", "--error-max"},
      {"--max=-1", "--max"}};
  for (const auto& [wrong, told] : mistakes) {
    const Outcome outcome = run("psf compare " + a + " " + a + " " + wrong);
    INFO(wrong << "\n" << outcome.err);
    CHECK(outcome.code == 2);
    CHECK(outcome.out.empty());
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(outcome.err.find(told) != std::string::npos);
  }
}
