#include "run/many_adder.h"

#include "core/parallel.h"

namespace psf::run {

void ManyAdder::start(const filter::Records& records, std::span<ManyPictures> pictures) {
  r_ = &records;
  pictures_ = pictures;
  overflows_ = 0;
  for (std::size_t k = owner_.size(); k < pictures.size(); ++k) {
    owner_.emplace_back(pictures[k].width() * pictures[k].height(), 0);
  }
}

void ManyAdder::begin(std::span<const std::uint32_t> queries, std::size_t grain) {
  queries_ = queries;
  grain_ = grain;
  parts_.resize(core::range_count(queries.size(), grain));
  for (std::size_t q = 0; q < queries.size(); ++q) {
    std::uint64_t& owner = owner_of(queries[q]);
    if (owner < before_) owner = before_ + q / grain;
  }
}

void ManyAdder::take(std::size_t part, std::size_t first, std::size_t count,
                     std::span<const Rgb> c_bar) {
  Part& own = parts_[part];
  const std::size_t begin = part * grain_;
  for (std::size_t q = 0; q * count < c_bar.size(); ++q) {
    const std::uint32_t i = queries_[begin + q];
    const std::span<const Rgb> of_i = c_bar.subspan(q * count, count);
    if (owner_of(i) == before_ + part) {
      add(own.overflows, i, first, of_i);
    } else {
      if (own.late.empty()) {  // room for all at once: memory() is the most there is
        own.late.reserve(grain_);
        own.c_bar.reserve(grain_ * count);
      }
      own.late.push_back({i, first, count});
      own.c_bar.insert(own.c_bar.end(), of_i.begin(), of_i.end());
    }
  }
}

void ManyAdder::end() {
  // Pixels in shares, each in the order of the parts.
  core::parallel_for(kShares, 1, [&](std::size_t share, std::size_t) {
    for (const Part& part : parts_) {
      std::size_t at = 0;
      for (const Late& late : part.late) {
        if (r_->pixel[late.record] % kShares == share) {
          add(shares_[share], late.record, late.first, {&part.c_bar[at], late.count});
        }
        at += late.count;
      }
    }
  });
  for (Part& part : parts_) {
    leave_out(part.overflows);
    part.late.clear();
    part.c_bar.clear();
  }
  for (Overflows& overflows : shares_) leave_out(overflows);
  before_ += parts_.size();
}

void ManyAdder::add(Overflows& overflows, std::uint32_t i, std::size_t first,
                    std::span<const Rgb> c_bar) {
  if (ManyPictures::overflows(*r_, roles_[i], i)) {
    for (std::size_t k = 0; k < c_bar.size(); ++k) overflows.push_back({i, first + k, true});
    return;
  }
  pictures_[camera_of(i)].add_filtered(*r_, i, first, c_bar, [&](std::size_t radius) {
    overflows.push_back({i, radius, false});
  });
}

void ManyAdder::leave_out(Overflows& overflows) {
  for (const auto& [record, radius, everywhere] : overflows) {
    if (!everywhere) pictures_[camera_of(record)].leave_out(*r_, record, radius);
  }
  overflows_ += overflows.size();
  overflows.clear();
}

std::uint64_t ManyAdder::memory(std::size_t radii) {
  return kMostQueries * (radii * sizeof(Rgb) + sizeof(Late));
}

}  // namespace psf::run
