// Reads OBJ by our own reader: libraries for it take what is no number and indices out of range for
// something else, without a word, and cut names at spaces.
#include "render/scene/obj/file.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <map>
#include <utility>

#include "core/error.h"
#include "render/scene/text_lines.h"

namespace psf::render {
namespace {

class ObjReader {
 public:
  ObjReader(const std::string& path, const Space& space, LeftOut& left_out)
      : lines_(path), space_(space), left_out_(left_out) {}

  ObjFile run() {
    while (lines_.next()) read_statement();
    for (const Kind& kind : kinds_) {
      if (kind.largest > kind.count) {
        fail_at(kind.largest_line, fmt::format("the face names {} {}, there are {}", kind.name,
                                               kind.largest, kind.count));
      }
    }
    return std::move(file_);
  }

 private:
  struct Kind {
    const char* name;
    std::int64_t count = 0;
    std::int64_t largest = 0;  // index that any face names, from 1
    std::size_t largest_line = 0;
  };

  void read_statement() {
    const std::string_view statement = lines_.statement();
    if (statement == "v") return read_vertex();
    if (statement == "vt") return read_uv();
    if (statement == "vn") return read_normal();
    if (statement == "f" || statement == "fo") return read_face();  // fo: of old files
    if (statement == "o" || statement == "g") {
      object_ = lines_.rest();
      ++object_number_;
      part_ = nullptr;
    } else if (statement == "usemtl") {
      material_ = lines_.rest();
      part_ = nullptr;
    } else if (statement == "mtllib") {
      file_.libraries.push_back({std::string(lines_.rest()), lines_.line()});
    } else if (statement == "s") {
      const std::string_view group = lines_.word();
      smooth_ = !group.empty() && group != "off" && group != "0";
    } else {
      // Free-form curves and surfaces, points, lines, display attributes; or no OBJ at all.
      left_out_.add_statement(statement);
    }
  }

  void read_vertex() {
    const auto number = static_cast<std::size_t>(++kinds_[0].count);
    // x y z, then a weight or a colour, or the weight and the colour.
    Imath::V3d p(0, 0, 0);
    int numbers = 0;
    for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word()) {
      const double value = lines_.to_real(word, "vertex", number);
      if (numbers < 3) p[numbers] = value;
      if (numbers == 3) weight_ = static_cast<float>(value);
      ++numbers;
    }
    if (numbers < 3) fail_count("vertex", number, numbers, 3);
    if ((numbers == 4 || numbers == 7) && weight_ != 1) left_out_.add("weights of vertices");
    if (numbers == 5) fail_count("vertex", number, numbers, 6);
    if (numbers >= 6) left_out_.add("vertex colours");
    file_.positions.push_back(space_.local(p));
    file_.bounds.extendBy(p);
  }

  void read_uv() {
    const auto number = static_cast<std::size_t>(++kinds_[1].count);
    const float u = lines_.number("texture coordinate", number);
    float v = 0;
    int numbers = 1;
    // A third number is for solid textures, which MTL does not have.
    for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word()) {
      const float value = lines_.to_number(word, "texture coordinate", number);
      if (numbers++ == 1) v = value;
    }
    file_.uvs.emplace_back(u, v);
  }

  void read_normal() {
    const auto number = static_cast<std::size_t>(++kinds_[2].count);
    std::array<float, 3> n{};
    int numbers = 0;
    for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word(), ++numbers) {
      const float value = lines_.to_number(word, "normal", number);
      if (numbers < 3) n[static_cast<std::size_t>(numbers)] = value;
    }
    if (numbers < 3) fail_count("normal", number, numbers, 3);
    if (numbers > 3) left_out_.add("a fourth number of normals");
    file_.normals.emplace_back(n[0], n[1], n[2]);
  }

  // Words v, v/t, v//n or v/t/n; negative ones count back from the last.
  void read_face() {
    ObjFace face{file_.corners.size(), 0, static_cast<std::uint32_t>(lines_.line())};
    bool all_normals = true;
    for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word()) {
      std::array<std::uint32_t, 3> index{ObjCorner::kNo, ObjCorner::kNo, ObjCorner::kNo};
      std::string_view rest = word;
      for (std::size_t k = 0;; ++k) {
        const std::size_t end = std::min(rest.find('/'), rest.size());
        const std::string_view digits = rest.substr(0, end);
        if (!digits.empty() || k == 0) index[k] = read_index(word, digits, kinds_[k]);
        if (end == rest.size()) break;
        if (k == 2) fail_corner(word);
        rest.remove_prefix(end + 1);
      }
      file_.corners.push_back({index[0], index[1], index[2]});
      all_normals = all_normals && index[2] != ObjCorner::kNo;
    }
    face.corners = static_cast<std::uint32_t>(file_.corners.size() - face.first);
    if (face.corners < 3) {
      file_.corners.resize(face.first);
      left_out_.add("faces of one or two corners");
      return;
    }
    if (smooth_ && !all_normals) left_out_.add("smoothing groups of faces without normals");
    part().faces.push_back(face);
  }

  std::uint32_t read_index(std::string_view word, std::string_view digits, Kind& kind) {
    std::int64_t index = 0;
    if (digits.size() > 1 && digits[0] == '+') digits.remove_prefix(1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
    if (error != std::errc() || end != digits.data() + digits.size() || index == 0)
      fail_corner(word);
    if (index < -kind.count) {
      lines_.fail(fmt::format("the face names {} {}, there are {} before it", kind.name, index,
                              kind.count));
    }
    if (index > kind.largest) {
      kind.largest = index;
      kind.largest_line = lines_.line();
    }
    const std::int64_t place = index > 0 ? index - 1 : kind.count + index;
    if (place >= std::int64_t{ObjCorner::kNo}) return 0;  // run() says that there are not so many
    return static_cast<std::uint32_t>(place);
  }

  ObjPart& part() {
    if (part_ != nullptr) return file_.parts[*part_];
    const auto [entry, is_new] =
        part_of_.try_emplace({object_number_, material_}, file_.parts.size());
    if (is_new) file_.parts.push_back({object_, material_, lines_.line(), {}});
    part_ = &entry->second;
    return file_.parts[*part_];
  }

  [[noreturn]] void fail_corner(std::string_view word) const {
    lines_.fail(fmt::format("the face's corner \"{}\" is no index, they start with 1", word));
  }
  [[noreturn]] void fail_count(const char* kind, std::size_t number, int numbers, int least) const {
    lines_.fail(fmt::format("{} {} has {} numbers, it needs {}", kind, number, numbers, least));
  }
  [[noreturn]] void fail_at(std::size_t line, const std::string& what) const {
    throw Error(ErrorCode::bad_input, fmt::format("{}:{}: {}", lines_.path(), line, what));
  }

  TextLines lines_;
  const Space& space_;
  LeftOut& left_out_;
  ObjFile file_;
  std::array<Kind, 3> kinds_{Kind{"vertex"}, Kind{"texture coordinate"}, Kind{"normal"}};
  std::string object_, material_;
  std::size_t object_number_ = 0;
  std::map<std::pair<std::size_t, std::string>, std::size_t> part_of_;  // object and material
  const std::size_t* part_ = nullptr;  // part of the next face; null: still to be looked up
  float weight_ = 1;
  bool smooth_ = false;
};

}  // namespace

ObjFile read_obj(const std::string& path, const Space& space, LeftOut& left_out) {
  return ObjReader(path, space, left_out).run();
}

}  // namespace psf::render
