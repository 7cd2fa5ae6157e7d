// The average over a frame and those around it: README.md, "Windows of frames".
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filter/estimate.h"
#include "filter/sum.h"

namespace psf::filter {

struct WindowTerms {
  // T of [relit], > 0; not set: all that the ball of another frame holds counts. Measured in
  // README.md.
  std::optional<double> relit = 1.5;
  bool rest = false;  // other frames are searched at rest positions

  // Throws Error{usage} that says what of the parameters does not go with other frames.
  void validate_with(const Parameters& parameters) const;
};

struct WindowCounts {
  std::uint64_t found = 0, alike = 0;  // balls in other frames with a source; those that count
  std::uint64_t orphans = 0;           // orphans of the frame itself that average other frames
  WindowCounts& operator+=(const WindowCounts& other) {
    found += other.found;
    alike += other.alike;
    orphans += other.orphans;
    return *this;
  }
};

// Starts from estimate() of a block of the frame itself, and takes in blocks of other frames one by
// one. An orphan, whose ball has no source in the frame itself, averages those of the other frames
// alone, where they count; [relit] has nothing of the frame itself to compare them with, so that
// they do only without it.
class FrameWindow {
 public:
  // As estimate() has them; all must outlive the window. Throws what estimate() throws, and
  // validate_with().
  FrameWindow(const Records& records, std::span<const float> radius, const Block& block,
              const Parameters& parameters, const WindowTerms& terms);

  // A block of another frame, with the same channels and layers. Throws Error{interrupted} on ^C.
  void add(const Records& other, const Block& block);

  // What estimate() returns, with the other frames in the averages and the numbers of neighbours.
  // Where none of them counted, c_bar is that of estimate() bit for bit. Its numbers of orphans are
  // those of the frame itself.
  [[nodiscard]] Estimates finish();
  // Of the orphans after finish().
  [[nodiscard]] const WindowCounts& counts() const { return counts_; }

 private:
  // What a run over a pair of frames hands on: of every query the means of its ball, and the number
  // of sources there. The first mean is that of luminances, of their squares and of who has moved,
  // where has_moments(); then come c and the layers, unless only moments were wanted.
  using UseMeans = std::function<void(std::span<const std::uint32_t> queries,
                                      std::span<const std::vector<Rgb>> means,
                                      std::span<const std::uint32_t> neighbors)>;
  enum class Want : std::uint8_t { moments, all };
  void visit_pairs(const Records& other, const Block& block, bool rest, Want want,
                   const UseMeans& use) const;
  [[nodiscard]] std::vector<std::vector<Rgb>> values_of(const Records& records, const Roles& roles,
                                                        Want want) const;
  // The sources in a ball: how many, and the mean of what visit_pairs() puts first.
  struct Ball {
    std::uint32_t count = 0;
    Rgb mean = Rgb(0, 0, 0);
  };
  [[nodiscard]] bool has_moments() const { return terms_.relit || terms_.rest; }
  [[nodiscard]] bool is_alike(std::uint32_t i, const Ball& other) const;
  void take_in(std::span<const std::uint32_t> queries, std::span<const std::vector<Rgb>> means,
               std::span<const std::uint32_t> neighbors);

  const Records& records_;
  std::span<const float> radius_;
  const Block& block_;
  const Parameters& parameters_;
  WindowTerms terms_;
  Estimates result_;
  int exponent_;                        // luminances times 2^exponent_ have squares in float
  std::vector<Ball> own_;               // by record, in the frame itself
  std::vector<std::vector<Sum>> sums_;  // by average, c first, and record; empty: nothing came
  std::vector<std::uint32_t> added_;    // sources of other frames, by record
  WindowCounts counts_;
};

}  // namespace psf::filter
