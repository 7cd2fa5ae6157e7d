// Adds the averages of a traversal for many radii to the pictures of its cameras, on all threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filter/many_radii.h"
#include "run/many_pictures.h"

namespace psf::run {

// In a slab, each pixel belongs to the first part that has a query in it; this part adds to the
// pixel at once. The averages of other parts for the pixel wait until the end of the slab. So no
// two threads add to one pixel, and the sums are the same for any number of threads. Few averages
// wait, because queries near to each other are in the same part.
class ManyAdder : public filter::Receiver {
 public:
  // Call this before each block with its records and a picture for each camera, the same cameras
  // each time. Both are borrowed.
  void start(const filter::Records& records, std::span<ManyPictures> pictures);

  void set_roles(std::span<const filter::Role> roles) override { roles_ = roles; }
  void begin(std::span<const std::uint32_t> queries, std::size_t grain) override;
  void take(std::size_t part, std::size_t first, std::size_t count,
            std::span<const Rgb> c_bar) override;
  void end() override;

  // The number of overflows of paths of the block, over all radii.
  [[nodiscard]] std::uint64_t overflows() const { return overflows_; }

  // The most bytes that waiting averages take.
  [[nodiscard]] static std::uint64_t memory(std::size_t radii);
  static constexpr std::uint64_t kBytesAPixel = sizeof(std::uint64_t);

 private:
  struct Overflow {
    std::uint32_t record;
    std::size_t radius;
    bool everywhere;  // the record is in no picture, since add_record() does not add it
  };
  using Overflows = std::vector<Overflow>;
  struct Late {
    std::uint32_t record;
    std::size_t first, count;  // radii
  };
  struct Part {
    std::vector<Late> late;
    std::vector<Rgb> c_bar;  // the averages of all late records
    Overflows overflows;
  };
  static constexpr std::size_t kShares = 16;  // into which the pixels are divided

  void add(Overflows& overflows, std::uint32_t i, std::size_t first, std::span<const Rgb> c_bar);
  void leave_out(Overflows& overflows);
  [[nodiscard]] std::size_t camera_of(std::uint32_t i) const {
    return r_->camera.empty() ? 0 : r_->camera[i];
  }
  [[nodiscard]] std::uint64_t& owner_of(std::uint32_t i) {
    return owner_[camera_of(i)][r_->pixel[i]];
  }

  const filter::Records* r_ = nullptr;
  std::span<ManyPictures> pictures_;
  std::span<const filter::Role> roles_;
  std::span<const std::uint32_t> queries_;
  std::size_t grain_ = 0;
  // By camera and pixel: the first part with a query in it. Parts are numbered over all slabs, from
  // 1.
  std::vector<std::vector<std::uint64_t>> owner_;
  std::uint64_t before_ = 1;  // the number of the slab's first part
  std::vector<Part> parts_;
  std::array<Overflows, kShares> shares_;  // overflows of late records
  std::uint64_t overflows_ = 0;
};

}  // namespace psf::run
