// Adds what a traversal for many radii averages to the pictures of its cameras, on all threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filter/many_radii.h"
#include "study/many_pictures.h"

namespace psf::study {

// In a slab the part of queries that meets a pixel first adds to it as it goes. What other parts
// have for the pixel waits for the end of the slab, so that no two threads add to one pixel and the
// sums are the same for any number of threads. Queries near to each other share parts: few wait.
class ManyAdder : public filter::Receiver {
 public:
  // Before a block: its records, and a picture for each camera, the same cameras each time; both
  // borrowed.
  void start(const filter::Records& records, std::span<ManyPictures> pictures);

  void set_roles(std::span<const filter::Role> roles) override { roles_ = roles; }
  void begin(std::span<const std::uint32_t> queries, std::size_t grain) override;
  void take(std::size_t part, std::size_t first, std::size_t count,
            std::span<const Rgb> c_bar) override;
  void end() override;

  // Of paths of the block, over all radii.
  [[nodiscard]] std::uint64_t overflows() const { return overflows_; }

  // Bytes of what waits, at most.
  [[nodiscard]] static std::uint64_t memory(std::size_t radii);
  static constexpr std::uint64_t kBytesAPixel = sizeof(std::uint64_t);

 private:
  struct Overflow {
    std::uint32_t record;
    std::size_t radius;
    bool everywhere;  // it is in no picture: add_record() adds nothing of it
  };
  using Overflows = std::vector<Overflow>;
  struct Late {
    std::uint32_t record;
    std::size_t first, count;  // radii
  };
  struct Part {
    std::vector<Late> late;
    std::vector<Rgb> c_bar;  // of all who are late
    Overflows overflows;
  };
  static constexpr std::size_t kShares = 16;  // of the pixels

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
  // By camera and pixel: the part that met it first, counted over all slabs from 1 on.
  std::vector<std::vector<std::uint64_t>> owner_;
  std::uint64_t before_ = 1;  // the number of the slab's first part
  std::vector<Part> parts_;
  std::array<Overflows, kShares> shares_;  // of those who are late
  std::uint64_t overflows_ = 0;
};

}  // namespace psf::study
