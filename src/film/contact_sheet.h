// A contact sheet: pictures of one size beside each other on a page, with labels, as a PNG.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/vec.h"
#include "film/lettering.h"

namespace psf::film {

// Pixels of a picture.
struct Crop {
  std::size_t x = 0, y = 0, width = 0, height = 0;
};

struct SheetOptions {
  std::size_t columns = 5;   // at least 1
  float exposure = 0;        // stops, of all pictures alike
  std::optional<Crop> crop;  // what is shown of each picture; not set: all of it
};

class ContactSheet {
 public:
  // `width`, `height`: of every picture. Throws Error{usage} where the crop is empty or reaches out
  // of them, or where there is no column.
  ContactSheet(std::size_t width, std::size_t height, const SheetOptions& options);

  // The lines at the head of the page; the first is larger.
  void set_head(std::vector<std::string> lines) { head_ = std::move(lines); }
  // Begins a new row of pictures, under a heading.
  void add_section(std::string heading) { sections_.push_back({std::move(heading), {}}); }
  // Adds (height, width) linear colours to the last section, shown as write_png() shows them, with
  // two lines below; a line may be empty.
  void add(std::span<const Rgb> picture, std::string label, std::string detail);

  // The page. Crops much narrower than kCell are enlarged, each pixel to a square. Throws
  // Error{limit} where it has more than 2^30 pixels.
  [[nodiscard]] Canvas draw() const;
  // The bytes of the file that write() writes. Throws what draw() throws.
  [[nodiscard]] std::vector<std::uint8_t> png() const;
  // Throws what draw() throws, and Error{io}.
  void write(const std::string& path) const;

  static constexpr std::size_t kCell = 256;  // pixels

 private:
  struct Cell {
    std::vector<std::uint8_t> pixels;  // (rows, columns, 3) of the crop, sRGB
    std::string label, detail;
  };
  struct Section {
    std::string heading;
    std::vector<Cell> cells;
  };
  class Page;

  std::size_t width_, height_;
  SheetOptions options_;
  Crop crop_;
  std::vector<std::string> head_;
  std::vector<Section> sections_;
};

}  // namespace psf::film
