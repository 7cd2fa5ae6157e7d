#include "explain/explain.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/parallel.h"
#include "explain/block.h"
#include "filter/blocks.h"
#include "filter/channels.h"

namespace psf::explain {
namespace {

constexpr std::uint64_t kScan = std::uint64_t{1} << 20;  // records whose pixels are read at a time

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::usage, why);
}

std::string name_of(const run::Dump& dump, std::size_t camera) {
  return fmt::format("camera \"{}\"", dump.metadata().cameras[camera].name);
}

// All that a term can look at, where the file has it, beside what the parameters need.
run::ChannelSet select_all(const run::Dump& dump, const filter::Parameters& parameters) {
  static_cast<void>(dump.select(parameters, true));  // names what this run misses
  const auto has = [&dump](std::string_view channel) { return dump.has(channel); };
  filter::Parameters all = parameters;
  // With a term the channels that it needs are read, whatever its threshold.
  for (std::size_t k = 0; k < filter::kTermCount; ++k) {
    const filter::TermInfo& term = filter::kTerms[k];
    const bool is_possible =
        std::all_of(term.channels.begin(), term.channels.end(),
                    [&](std::string_view channel) { return channel.empty() || has(channel); });
    if (!is_possible) continue;
    if (term.threshold == nullptr) all.weights.*term.is_on = true;
    if (term.threshold != nullptr) all.weights.*term.threshold = 1.0f;
  }
  if (has("distance") && all.radius.basis == filter::RadiusBasis::world) {
    all.radius.basis = filter::RadiusBasis::distance;
  }
  return dump.select(all, true);
}

void append(const filter::Records& from, std::size_t i, run::BlockRecords& to) {
  filter::for_each_channel([&](const char*, const auto& member) {
    if (!member(from).empty()) member(to).push_back(member(from)[i]);
  });
}

class Explainer {
 public:
  Explainer(const run::Dump& dump, const ExplainRequest& request)
      : dump_(dump), channels_(select_all(dump, request.parameters)), room_(request.most_pairs) {
    result_.request = request;
    for (const filter::CameraView& camera : dump.cameras()) result_.widths.push_back(camera.width);
    const std::size_t last = run::last_pass(dump, request.passes);
    result_.passes = last - request.passes.first;
    blocks_.emplace(request.parameters.block, dump.pass_bounds(), request.passes.first, last);
  }

  ExplainResult run() {
    find_paths();
    std::size_t next = 0;
    for (std::uint64_t k = 0; k < blocks_->count() && next < records_of_paths_.size(); ++k) {
      const filter::PathRange range = (*blocks_)[k];
      std::vector<std::uint32_t> members;
      for (; next < records_of_paths_.size() && records_of_paths_[next] < range.last; ++next) {
        members.push_back(static_cast<std::uint32_t>(records_of_paths_[next] - range.first));
      }
      if (!members.empty()) add_block(k, range, members);
    }
    return std::move(result_);
  }

 private:
  void find_paths() {
    const ExplainRequest& request = result_.request;
    const filter::PathRange all = blocks_->all();
    if (request.path) {
      records_of_paths_ = {*request.path};
      return;
    }
    const filter::CameraView& camera = dump_.cameras()[request.camera];
    run::ChannelSet pixels;
    pixels.pixel = channels_.pixel;
    pixels.camera = channels_.camera;
    const std::uint32_t wanted = request.y * camera.width + request.x;
    run::BlockRecords records;
    for (std::uint64_t first = all.first; first < all.last; first += kScan) {
      core::throw_if_interrupted("nothing was explained");
      dump_.read({first, std::min(first + kScan, all.last)}, pixels, records);
      for (std::size_t i = 0; i < records.pixel.size(); ++i) {
        if (records.pixel[i] != wanted) continue;
        if (!records.camera.empty() && records.camera[i] != request.camera) continue;
        records_of_paths_.push_back(first + i);
      }
    }
    if (records_of_paths_.empty()) {
      throw Error(
          ErrorCode::bad_input,
          fmt::format("{}: none of the paths chosen falls into pixel {},{} of {}; choose "
                      "another pixel or more `passes`",
                      dump_.reader().path(), request.x, request.y, name_of(dump_, request.camera)));
    }
  }

  void add_block(std::uint64_t k, const filter::PathRange& range,
                 const std::vector<std::uint32_t>& members) {
    core::throw_if_interrupted("nothing was explained");
    dump_.read(range, channels_, block_records_);
    const filter::Block block =
        describe_block(dump_, *blocks_, k, result_.request.parameters.radius.count);
    const BlockExplainer explainer(block_records_.view(), block, result_.request.parameters);
    std::vector<ExplainedPath> paths(members.size());
    std::vector<std::vector<ExplainedPair>> pairs(members.size());
    core::parallel_for(members.size(), 1, [&](std::size_t m, std::size_t) {
      paths[m] = explainer.explain(members[m], pairs[m], room_);
    });
    ++result_.blocks;
    add(explainer, range.first, paths, pairs);
    if (result_.request.on_progress) {
      result_.request.on_progress(range.last - blocks_->all().first, blocks_->all().size());
    }
  }

  // Turns record numbers of the block into vertices of the explanation.
  void add(const BlockExplainer& explainer, std::uint64_t first,
           std::span<const ExplainedPath> paths, std::span<std::vector<ExplainedPair>> pairs) {
    std::vector<std::uint32_t> used;
    for (const ExplainedPath& path : paths) used.push_back(path.vertex);
    for (const auto& of_path : pairs) {
      for (const ExplainedPair& pair : of_path) used.push_back(pair.vertex);
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const std::size_t base = result_.record.size();
    const auto vertex_of = [&](std::uint32_t i) {
      return static_cast<std::uint32_t>(
          base +
          static_cast<std::size_t>(std::lower_bound(used.begin(), used.end(), i) - used.begin()));
    };
    for (std::size_t m = 0; m < paths.size(); ++m) {
      ExplainedPath path = paths[m];
      path.vertex = vertex_of(path.vertex);
      path.begin = result_.pairs.size();
      for (ExplainedPair pair : pairs[m]) {
        pair.vertex = vertex_of(pair.vertex);
        pair.path = static_cast<std::uint32_t>(result_.paths.size());
        result_.pairs.push_back(pair);
      }
      path.end = result_.pairs.size();
      result_.paths.push_back(path);
    }
    const auto& bounds = dump_.pass_bounds();
    for (const std::uint32_t i : used) {
      append(block_records_.view(), i, result_.vertices);
      result_.record.push_back(first + i);
      const auto next = std::upper_bound(bounds.begin(), bounds.end(), first + i);
      result_.pass.push_back(static_cast<std::uint32_t>(next - bounds.begin() - 1));
      result_.is_source.push_back(explainer.is_source(i));
      result_.value.push_back(explainer.value(i));
      if (auto firefly = explainer.firefly(i)) {
        firefly->vertex = static_cast<std::uint32_t>(result_.record.size() - 1);
        result_.fireflies.push_back(*firefly);
      }
    }
  }

  const run::Dump& dump_;
  run::ChannelSet channels_;
  std::optional<filter::Blocks> blocks_;
  std::vector<std::uint64_t> records_of_paths_;
  run::BlockRecords block_records_;
  std::atomic<std::int64_t> room_;
  ExplainResult result_;
};

}  // namespace

void check(const run::Dump& dump, const ExplainRequest& request) {
  request.parameters.validate();
  if (!filter::info(request.parameters.estimator).is_of_ball) {
    std::vector<std::string_view> names;
    for (const filter::EstimatorInfo& estimator : filter::estimators()) {
      if (estimator.is_of_ball) names.push_back(estimator.name);
    }
    refuse(fmt::format("`estimator`: only those that average over a ball can be explained: {}",
                       fmt::join(names, ", ")));
  }
  const std::uint64_t last = dump.pass_bounds()[run::last_pass(dump, request.passes)];
  const std::uint64_t first = dump.pass_bounds()[request.passes.first];
  if (request.path) {
    if (*request.path >= first && *request.path < last) return;
    refuse(fmt::format("`path`: {} is not among the paths {} to {} of the passes chosen",
                       *request.path, first, last - 1));
  }
  if (request.parameters.pixels != filter::PixelRule::keep) {
    refuse(
        "`pixels`: what pixels around bring to one cannot be explained; give `pixels keep`, which "
        "explains the pixel that they are taken for");
  }
  if (request.camera >= dump.cameras().size()) refuse("`camera`: there is no such camera");
  const filter::CameraView& camera = dump.cameras()[request.camera];
  if (request.x < camera.width && request.y < camera.height) return;
  refuse(fmt::format("`pixel`: {},{} is outside the picture of {}, 0,0 to {},{}", request.x,
                     request.y, name_of(dump, request.camera), camera.width - 1,
                     camera.height - 1));
}

ExplainResult explain(const run::Dump& dump, const ExplainRequest& request) {
  check(dump, request);
  return Explainer(dump, request).run();
}

}  // namespace psf::explain
