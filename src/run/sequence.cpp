#include "run/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/error.h"
#include "core/number.h"
#include "core/numbered_name.h"

namespace psf::run {
namespace {

namespace fs = std::filesystem;

// The number that stands in `name` for the mark of `pattern`; none: it is no name of this kind.
std::optional<std::uint32_t> number_in(const std::string& name, const std::string& pattern) {
  const std::size_t at = pattern.find(core::kNumberMark);
  const std::size_t behind = pattern.size() - at - core::kNumberMark.size();
  if (name.size() < at + core::kNumberMark.size() + behind) return std::nullopt;
  const auto number = core::parse_number<std::uint32_t>(
      std::string_view(name).substr(at, name.size() - at - behind));
  return number && core::numbered(pattern, *number) == name ? number : std::nullopt;
}

}  // namespace

Sequence::Sequence(const std::string& path, const std::optional<VertexRule>& rule)
    : path_(path), rule_(rule) {
  if (core::is_numbered(fs::path(path).filename().string()) && !fs::exists(path)) {
    find_files();
    return;
  }
  whole_ = std::make_shared<const Dump>(path, rule);
  files_.push_back(path);
  const auto& info = whole_->metadata().frames;
  if (!info) throw Error(ErrorCode::usage, path + ": tells of no frames; it is no sequence");
  const std::size_t passes = whole_->pass_bounds().size() - 1;
  for (std::uint32_t k = 0; k < info->count && k * info->passes < passes; ++k) {
    frames_.push_back(info->first + k);
  }
}

void Sequence::find_files() {
  const fs::path pattern(path_);
  const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const auto number = number_in(entry.path().filename().string(), pattern.filename().string());
    if (number) frames_.push_back(*number);
  }
  std::sort(frames_.begin(), frames_.end());
  if (frames_.empty()) {
    throw Error(ErrorCode::io,
                fmt::format("{}: no file has this name with a number of four digits or more for {}",
                            path_, core::kNumberMark));
  }
  for (const std::uint32_t frame : frames_) files_.push_back(core::numbered(path_, frame));
}

DumpFrame Sequence::frame(std::uint32_t number) const {
  if (whole_) {
    const PassSelection passes = passes_of_frame(*whole_, number);
    return {std::make_shared<const Dump>(whole_->of_frame(number)), passes};
  }
  if (!std::binary_search(frames_.begin(), frames_.end(), number)) {
    throw Error(ErrorCode::usage, fmt::format("{}: has the frames {} to {}, {} is none of them",
                                              path_, frames_.front(), frames_.back(), number));
  }
  return {std::make_shared<const Dump>(core::numbered(path_, number), rule_, number), {}};
}

Window Sequence::around(std::uint32_t number, const Dump& dump, const WindowTexts& texts) const {
  Window window{texts.width, {}, texts.terms(dump)};
  for (const std::uint32_t other : frames_) {
    const std::uint32_t apart = other < number ? number - other : other - number;
    if (apart > 0 && apart <= texts.width / 2) window.others.push_back(frame(other));
  }
  return window;
}

Sequence Sequence::at(const std::optional<VertexRule>& rule) const {
  Sequence other = *this;
  other.rule_ = rule;
  if (whole_) other.whole_ = std::make_shared<const Dump>(whole_->at(rule));
  return other;
}

}  // namespace psf::run
