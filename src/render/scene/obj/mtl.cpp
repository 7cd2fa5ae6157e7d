// Reads MTL, version 4.2 of Alias|Wavefront's specification and the statements for physically based
// shading. By our own reader: libraries for it give numbers that they cannot read, and statements
// that are not there, values of their own.
#include "render/scene/obj/mtl.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/lower.h"
#include "render/scene/text_lines.h"

namespace psf::render {
namespace {

struct ColourStatement {
  std::string_view name;
  std::optional<Rgb> MtlMaterial::*colour;
  float most;
};
constexpr float kAny = 1e30f;
constexpr ColourStatement kColours[] = {{"ka", &MtlMaterial::ka, kAny},
                                        {"kd", &MtlMaterial::kd, 1},
                                        {"ks", &MtlMaterial::ks, 1},
                                        {"tf", &MtlMaterial::tf, 1},
                                        {"ke", &MtlMaterial::ke, kAny}};

struct NumberStatement {
  std::string_view name;
  std::optional<float> MtlMaterial::*number;
  float least, most;
};
constexpr NumberStatement kNumbers[] = {
    {"d", &MtlMaterial::d, 0, 1},          {"tr", &MtlMaterial::tr, 0, 1},
    {"ns", &MtlMaterial::ns, -kAny, kAny}, {"ni", &MtlMaterial::ni, 0, 10},
    {"pr", &MtlMaterial::pr, 0, 1},        {"pm", &MtlMaterial::pm, 0, 1}};

// Parts of physically based shading that we lack; exporters write them all, most of them 0.
constexpr std::string_view kLackedNumbers[] = {"ps", "pc", "pcr", "aniso", "anisor"};

// Options of a map, with the values that change nothing.
struct WordOption {
  std::string_view name, harmless;  // in lower case
};
constexpr WordOption kWordOptions[] = {{"-blendu", "on"}, {"-blendv", "on"},      {"-cc", "off"},
                                       {"-clamp", "off"}, {"-imfchan", ""},       {"-type", ""},
                                       {"-texres", ""},   {"-colorspace", "srgb"}};
struct NumberOption {
  std::string_view name;
  int least, most;  // how many
  float harmless[3];
};
constexpr NumberOption kNumberOptions[] = {{"-bm", 1, 1, {1}},      {"-boost", 1, 1, {0}},
                                           {"-mm", 2, 2, {0, 1}},   {"-o", 1, 3, {0, 0, 0}},
                                           {"-s", 1, 3, {1, 1, 1}}, {"-t", 1, 3, {0, 0, 0}}};

class MtlReader {
 public:
  MtlReader(const std::string& path, LeftOut& left_out) : lines_(path), left_out_(left_out) {}

  std::vector<MtlMaterial> run() {
    while (lines_.next()) read_statement();
    return std::move(materials_);
  }

 private:
  void read_statement() {
    const std::string statement = core::lower(lines_.statement());
    if (statement == "newmtl") {
      const std::string_view name = lines_.rest();
      if (name.empty()) lines_.fail("newmtl lacks a name");
      materials_.push_back({});
      materials_.back().name = name;
      materials_.back().line = lines_.line();
      return;
    }
    const auto is_it = [&](const auto& known) { return known.name == statement; };
    if (const auto colour = std::find_if(std::begin(kColours), std::end(kColours), is_it);
        colour != std::end(kColours)) {
      material().*colour->colour = read_colour(colour->most);
    } else if (const auto number = std::find_if(std::begin(kNumbers), std::end(kNumbers), is_it);
               number != std::end(kNumbers)) {
      if (statement == "d") read_halo();
      const float value = read_number(number->least, number->most);
      if (statement == "ni" && value > 0) check_range(value, 1, 10);  // 0: exporters say none
      material().*number->number = value;
    } else if (statement == "illum") {
      const float model = read_number(0, 10);
      if (model != static_cast<float>(static_cast<int>(model)))
        lines_.fail("illum is no whole number");
      material().illum = static_cast<int>(model);
      if (model == 10) left_out_.add("illum 10 (shadows on what is not seen)");
    } else if (statement == "map_kd") {
      material().map_kd = read_map();
    } else if (statement == "map_ke") {
      material().map_ke = read_map();
    } else if (statement == "norm" || statement == "bump" || statement == "map_bump") {
      read_relief(statement == "norm");
    } else if (statement == "map_d") {
      material().map_d = read_map();
    } else if (std::find(std::begin(kLackedNumbers), std::end(kLackedNumbers), statement) !=
               std::end(kLackedNumbers)) {
      if (read_number(-kAny, kAny) != 0) left_out_.add(lines_.statement());
    } else if (statement == "sharpness") {
      (void)read_number(0, kAny);        // belongs to reflection maps, which are left out by name
    } else if (statement != "map_ka") {  // light is simulated, no share of it is ambient
      left_out_.add_statement(lines_.statement());
    }
  }

  MtlMaterial& material() {
    if (materials_.empty())
      lines_.fail(fmt::format("{} stands before the first newmtl", lines_.statement()));
    return materials_.back();
  }

  float read_number(float least, float most) {
    float value = lines_.number(lines_.statement());
    if (!lines_.word().empty())
      left_out_.add(fmt::format("what follows the number of {}", lines_.statement()));
    drop_rounding(value, least, most);
    check_range(value, least, most);
    return value;
  }

  // What a converter rounded is no error.
  static void drop_rounding(float& value, float least, float most) {
    if (value > most && value < most * 1.0001f) value = most;
    if (least == 0 && value < 0 && value > -0.0001f) value = 0;
  }

  void check_range(float value, float least, float most) const {
    if (value >= least && value <= most) return;
    lines_.fail(most == kAny ? fmt::format("{} is {}, expected a number >= {}", lines_.statement(),
                                           value, least)
                             : fmt::format("{} is {}, expected a number in [{}, {}]",
                                           lines_.statement(), value, least, most));
  }

  // "r g b", or r alone for all three; "xyz x y z" is CIE XYZ.
  Rgb read_colour(float most) {
    const std::string_view kind = lines_.statement();
    std::string_view word = lines_.word();
    if (word == "spectral") {
      lines_.fail(fmt::format("{} spectral: spectral curves are not read, give r g b", kind));
    }
    const bool xyz = word == "xyz";
    if (xyz) word = lines_.word();
    Rgb colour(lines_.to_number(word, kind));
    word = lines_.word();
    if (!word.empty()) {
      colour.y = lines_.to_number(word, kind);
      colour.z = lines_.number(kind);
      if (!lines_.word().empty()) left_out_.add(fmt::format("a fourth number of {}", kind));
    }
    if (xyz) colour = from_xyz(colour);
    for (int c = 0; c < 3; ++c) {
      float& value = colour[c];
      drop_rounding(value, 0, most);
      check_range(value, 0, most);
    }
    return colour;
  }

  // IEC 61966-2-1: white is D65.
  static Rgb from_xyz(const Rgb& c) {
    return {3.2406f * c.x - 1.5372f * c.y - 0.4986f * c.z,
            -0.9689f * c.x + 1.8758f * c.y + 0.0415f * c.z,
            0.0557f * c.x - 0.2040f * c.y + 1.0570f * c.z};
  }

  void read_halo() {
    if (!lines_.rest().starts_with("-halo")) return;
    (void)lines_.word();
    left_out_.add("d -halo");
  }

  // Options, then the name, which may hold spaces and look like an option.
  MtlMaterial::Map read_map(bool multiplied = false) {
    (void)material();
    MtlMaterial::Map map;
    while (lines_.rest().starts_with('-')) {
      const std::string_view option = next();
      if (multiplied && core::lower(option) == "-bm") {
        lines_.skip(option.size());
        map.multiplier = lines_.number(option);
        continue;
      }
      const int known = read_option(option);
      if (known < 0) break;
      if (known == 0) left_out_.add(fmt::format("option {} of {}", option, lines_.statement()));
    }
    const std::string_view file = lines_.rest();
    if (file.empty())
      lines_.fail(fmt::format("{} lacks the name of a picture", lines_.statement()));
    map.file = file;
    map.line = lines_.line();
    return map;
  }

  // A picture of normals counts more than one of heights.
  void read_relief(bool of_normals) {
    const MtlMaterial::Map map = read_map(true);
    MtlMaterial& m = material();
    if (!m.relief.file.empty() && m.relief.file != map.file)
      left_out_.add("all but one picture of a material's relief");
    if (m.relief.file.empty() || of_normals) m.relief = map;
  }

  [[nodiscard]] std::string_view next() const {
    return lines_.rest().substr(0, lines_.rest().find_first_of(" \t"));
  }

  // 1 where the option changes nothing, 0 where it does, below where there is none of the name.
  int read_option(std::string_view option) {
    const auto is_it = [name = core::lower(option)](const auto& known) {
      return known.name == name;
    };
    if (const auto word = std::find_if(std::begin(kWordOptions), std::end(kWordOptions), is_it);
        word != std::end(kWordOptions)) {
      lines_.skip(option.size());
      const std::string value = core::lower(next());
      lines_.skip(value.size());
      return value == word->harmless ? 1 : 0;
    }
    const auto number = std::find_if(std::begin(kNumberOptions), std::end(kNumberOptions), is_it);
    if (number == std::end(kNumberOptions)) return -1;
    lines_.skip(option.size());
    bool harmless = true;
    for (int i = 0; i < number->most; ++i) {
      // The last word is the picture's name, even where it is a number.
      const bool last = next().size() == lines_.rest().size();
      if (i >= number->least && (last || !TextLines::is_number(next()))) break;
      harmless = lines_.number(option) == number->harmless[i] && harmless;
    }
    return harmless ? 1 : 0;
  }

  TextLines lines_;
  LeftOut& left_out_;
  std::vector<MtlMaterial> materials_;
};

}  // namespace

std::vector<MtlMaterial> read_mtl(const std::string& path, LeftOut& left_out) {
  return MtlReader(path, left_out).run();
}

}  // namespace psf::render
