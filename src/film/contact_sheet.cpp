#include "film/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/error.h"
#include "film/display.h"
#include "film/image.h"

namespace psf::film {
namespace {

constexpr Byte3 kPaper = {26, 26, 29}, kBright = {242, 242, 242}, kPlain = {216, 216, 218},
                kDim = {150, 150, 156};

// Heights of capitals, and distances, in pixels of a page whose cells are ContactSheet::kCell wide.
constexpr double kTitle = 18, kHeading = 14, kLabel = 11, kDetail = 10.5;
constexpr double kPageMargin = 28, kGutter = 14, kLeading = 9, kAboveSection = 24, kBelowTitle = 5,
                 kBelowHeading = 14, kBelowCell = 18;

// `pixels`, (height, width, 3), with each one as a square of zoom x zoom.
std::vector<std::uint8_t> enlarged(const std::vector<std::uint8_t>& pixels, std::size_t width,
                                   std::size_t zoom) {
  std::vector<std::uint8_t> result;
  result.reserve(pixels.size() * zoom * zoom);
  for (std::size_t row = 0; row < pixels.size(); row += 3 * width) {
    for (std::size_t y = 0; y < zoom; ++y) {
      for (std::size_t x = 0; x < width * zoom; ++x) {
        const std::size_t from = row + 3 * (x / zoom);
        result.insert(result.end(), {pixels[from], pixels[from + 1], pixels[from + 2]});
      }
    }
  }
  return result;
}

}  // namespace

// The layout: what is where, and the same steps again to draw it.
class ContactSheet::Page {
 public:
  explicit Page(const ContactSheet& sheet) : sheet_(sheet) {
    const std::size_t width = sheet.crop_.width;
    zoom_ = std::max<std::size_t>(1, (kCell + width / 2) / width);
    unit_ = std::max(1.0, static_cast<double>(width * zoom_) / static_cast<double>(kCell));
    cell_width_ = static_cast<double>(width * zoom_);
    std::size_t most = 1;
    for (const Section& section : sheet.sections_) {
      most = std::max(most, section.cells.size());
      for (const Cell& cell : section.cells) {
        cell_width_ = std::max({cell_width_, wide(cell.label, kLabel), wide(cell.detail, kDetail)});
        has_detail_ = has_detail_ || !cell.detail.empty();
      }
    }
    columns_ = std::min(sheet.options_.columns, most);
    const auto columns = static_cast<double>(columns_);
    right_ = at(kPageMargin) + columns * cell_width_ + (columns - 1) * at(kGutter);
    for (const std::string& line : sheet.head_) {
      right_ =
          std::max(right_, at(kPageMargin) + wide(line, line == sheet.head_[0] ? kTitle : kDetail));
    }
    for (const Section& section : sheet.sections_) {
      right_ = std::max(right_, at(kPageMargin) + wide(section.heading, kHeading));
    }
    lay_out(nullptr);
  }

  [[nodiscard]] std::size_t width() const { return whole(right_ + at(kPageMargin)); }
  [[nodiscard]] std::size_t height() const { return whole(y_); }

  [[nodiscard]] Canvas draw() {
    Canvas canvas(width(), height(), kPaper);
    lay_out(&canvas);
    return canvas;
  }

 private:
  static std::size_t whole(double value) { return static_cast<std::size_t>(std::lround(value)); }
  [[nodiscard]] double at(double distance) const { return std::round(distance * unit_); }
  [[nodiscard]] double wide(const std::string& text, double size) const {
    return std::ceil(text_width(text, size * unit_));
  }

  // From the top of the page to its foot, which is y_ then. `canvas`: null where nothing is drawn.
  void lay_out(Canvas* canvas) {
    y_ = at(kPageMargin);
    for (std::size_t k = 0; k < sheet_.head_.size(); ++k) {
      line(canvas, at(kPageMargin), sheet_.head_[k], k == 0 ? kTitle : kDetail,
           k == 0 ? kBright : kDim);
      if (k == 0) y_ += at(kBelowTitle);
    }
    for (const Section& section : sheet_.sections_) {
      y_ += at(kAboveSection);
      line(canvas, at(kPageMargin), section.heading, kHeading, kBright);
      y_ += at(kBelowHeading) - at(kLeading);
      for (std::size_t first = 0; first < section.cells.size(); first += columns_) {
        const std::size_t count = std::min(columns_, section.cells.size() - first);
        row(canvas, std::span(section.cells).subspan(first, count));
      }
      y_ -= at(kBelowCell);
    }
    y_ += at(kPageMargin) - at(kLeading);
  }

  // Cells beside each other.
  void row(Canvas* canvas, std::span<const Cell> cells) {
    const std::size_t width = sheet_.crop_.width * zoom_, height = sheet_.crop_.height * zoom_;
    const double top = y_;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double x = at(kPageMargin) + static_cast<double>(k) * (cell_width_ + at(kGutter));
      if (canvas != nullptr) {
        const std::vector<std::uint8_t> pixels =
            enlarged(cells[k].pixels, sheet_.crop_.width, zoom_);
        canvas->place(whole(x), whole(top), width, height, pixels.data());
      }
      y_ = top + static_cast<double>(height) + at(kLeading);
      line(canvas, x, cells[k].label, kLabel, kPlain);
      if (has_detail_) line(canvas, x, cells[k].detail, kDetail, kDim);
    }
    y_ += at(kBelowCell);
  }

  // Goes down by a line of text of this size.
  void line(Canvas* canvas, double x, const std::string& text, double size, const Byte3& color) {
    y_ += at(size);
    if (canvas != nullptr) draw_text(*canvas, x, y_, text, {size * unit_, color});
    y_ += at(kLeading);
  }

  const ContactSheet& sheet_;
  std::size_t zoom_ = 1, columns_ = 1;
  double unit_ = 1, cell_width_ = 0, right_ = 0, y_ = 0;
  bool has_detail_ = false;
};

ContactSheet::ContactSheet(std::size_t width, std::size_t height, const SheetOptions& options)
    : width_(width), height_(height), options_(options) {
  crop_ = options.crop.value_or(Crop{0, 0, width, height});
  if (options.columns == 0) throw Error(ErrorCode::usage, "`columns`: give at least 1");
  const bool is_inside = crop_.width > 0 && crop_.height > 0 && crop_.width <= width &&
                         crop_.x <= width - crop_.width && crop_.height <= height &&
                         crop_.y <= height - crop_.height;
  if (!is_inside) {
    throw Error(ErrorCode::usage,
                fmt::format("`crop {},{},{}x{}`: is empty or reaches out of the picture, which is "
                            "{}x{}",
                            crop_.x, crop_.y, crop_.width, crop_.height, width, height));
  }
}

void ContactSheet::add(std::span<const Rgb> picture, std::string label, std::string detail) {
  assert(picture.size() == width_ * height_ && !sections_.empty());
  Cell cell{{}, std::move(label), std::move(detail)};
  cell.pixels.reserve(3 * crop_.width * crop_.height);
  const float scale = std::exp2(options_.exposure);
  for (std::size_t y = crop_.y; y < crop_.y + crop_.height; ++y) {
    for (std::size_t x = crop_.x; x < crop_.x + crop_.width; ++x) {
      const Rgb& color = picture[y * width_ + x];
      for (const float component : {color.x, color.y, color.z}) {
        cell.pixels.push_back(displayed_byte(component * scale));
      }
    }
  }
  sections_.back().cells.push_back(std::move(cell));
}

Canvas ContactSheet::draw() const {
  constexpr std::size_t kMostPixels = std::size_t{1} << 30;  // 3 GiB
  Page page(*this);
  if (page.width() > kMostPixels / std::max<std::size_t>(1, page.height())) {
    throw Error(ErrorCode::limit,
                fmt::format("the sheet would be {} x {} pixels; give `crop X,Y,WxH`", page.width(),
                            page.height()));
  }
  return page.draw();
}

std::vector<std::uint8_t> ContactSheet::png() const {
  const Canvas canvas = draw();
  return encode_png_bytes(canvas.width, canvas.height, canvas.values);
}

void ContactSheet::write(const std::string& path) const {
  const Canvas canvas = draw();
  write_png_bytes(path, canvas.width, canvas.height, canvas.values);
}

}  // namespace psf::film
