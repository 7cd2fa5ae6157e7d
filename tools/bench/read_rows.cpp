#include "bench/read_rows.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "bench/dumps.h"
#include "core/error.h"
#include "core/parallel.h"
#include "formats/read/reader.h"

namespace psf::bench {
namespace {

constexpr std::size_t kBlockChunks = 16;  // read at a time into the same memory, as a filter does

// Where the bytes of one column lie in the file and in memory.
struct Extent {
  std::uint64_t offset = 0;
  std::span<std::byte> to;
};

// Some channels of a file, block by block, by the reader and by pread.
class Job {
 public:
  Job(const std::string& path, std::vector<std::size_t> channels)
      : reader_(path), channels_(std::move(channels)), memory_(channels_.size()) {
    file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file_ < 0) throw Error(ErrorCode::io, path + ": cannot open");
    const auto chunks = reader_.chunks();
    for (std::size_t begin = 0; begin < chunks.size(); begin += kBlockChunks) {
      add_block(chunks.subspan(begin, std::min(kBlockChunks, chunks.size() - begin)), begin);
    }
  }
  ~Job() { ::close(file_); }
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  void read() {
    for (const Block& block : blocks_) {
      for (std::size_t k = 0; k < channels_.size(); ++k) {
        const std::size_t size = block.count * stride(k);
        reader_.read(channels_[k], block.first, block.count, std::span(memory_[k]).first(size));
      }
    }
  }

  // Only for raw files, whose stored bytes are the values.
  void pread() {
    for (const Block& block : blocks_) {
      for (const auto& column : block.columns) {
        tbb::parallel_for(std::size_t{0}, column.size(), [&](std::size_t k) { fill(column[k]); });
      }
    }
  }

  [[nodiscard]] double bytes() const {
    std::size_t a_record = 0;
    for (std::size_t k = 0; k < channels_.size(); ++k) a_record += stride(k);
    return static_cast<double>(reader_.records() * a_record);
  }

 private:
  struct Block {
    std::uint64_t first = 0;
    std::size_t count = 0;
    std::vector<std::vector<Extent>> columns;  // by channel, by chunk
  };

  [[nodiscard]] std::size_t stride(std::size_t k) const {
    return reader_.head().channels[channels_[k]].stride();
  }

  void add_block(std::span<const formats::ChunkEntry> chunks, std::size_t index) {
    Block block;
    block.first = chunks.front().first;
    for (const auto& entry : chunks) block.count += entry.count;
    block.columns.resize(channels_.size());
    for (std::size_t k = 0; k < channels_.size(); ++k) {
      if (memory_[k].size() < block.count * stride(k)) memory_[k].resize(block.count * stride(k));
    }
    for (const auto& entry : chunks) {
      const auto columns = reader_.columns(index++);
      for (std::size_t k = 0; k < channels_.size(); ++k) {
        const std::size_t from = (entry.first - block.first) * stride(k);
        block.columns[k].push_back({entry.offset + columns[channels_[k]].offset,
                                    std::span(memory_[k]).subspan(from, entry.count * stride(k))});
      }
    }
    blocks_.push_back(std::move(block));
  }

  void fill(const Extent& extent) const {
    std::span<std::byte> to = extent.to;
    for (std::uint64_t offset = extent.offset; !to.empty();) {
      const ssize_t got = ::pread(file_, to.data(), to.size(), static_cast<off_t>(offset));
      if (got <= 0) throw Error(ErrorCode::io, reader_.path() + ": cannot be read");
      offset += static_cast<std::uint64_t>(got);
      to = to.subspan(static_cast<std::size_t>(got));
    }
  }

  formats::Reader reader_;
  std::vector<std::size_t> channels_;
  std::vector<std::vector<std::byte>> memory_;  // by channel, as large as the largest block needs
  std::vector<Block> blocks_;
  int file_ = -1;
};

std::vector<std::size_t> all_channels(const std::string& path) {
  std::vector<std::size_t> channels(formats::Reader(path).head().channels.size());
  std::iota(channels.begin(), channels.end(), 0);
  return channels;
}

// What a look at the dump needs first; where it lacks one, whichever comes first.
std::vector<std::size_t> three_channels(const std::string& path) {
  const formats::Reader reader(path);
  std::vector<std::size_t> channels;
  for (const char* name : {"position", "normal", "contribution"}) {
    if (const auto found = reader.head().find(name)) channels.push_back(*found);
  }
  for (std::size_t k = 0; k < reader.head().channels.size() && channels.size() < 3; ++k) {
    if (std::find(channels.begin(), channels.end(), k) == channels.end()) channels.push_back(k);
  }
  return channels;
}

std::string speed(double bytes, const std::vector<double>& seconds) {
  return fmt::format("{:.2f} GB/s", bytes / 1e9 / spread(seconds).median);
}

// Times both calls in turn and returns their seconds; the first turn is not counted.
template <class A, class B>
std::array<std::vector<double>, 2> in_turn(std::size_t repeat, const A& a, const B& b) {
  std::array<std::vector<double>, 2> seconds;
  for (std::size_t k = 0; k <= repeat; ++k) {
    const double first = seconds_of(a), second = seconds_of(b);
    if (k == 0) continue;
    seconds[0].push_back(first);
    seconds[1].push_back(second);
  }
  return seconds;
}

Row raw_row(const std::string& path, std::size_t threads, std::size_t repeat) {
  const core::ThreadLimit limit(threads);
  Job job(path, all_channels(path));
  const auto [pread, read] = in_turn(
      repeat, [&] { job.pread(); }, [&] { job.read(); });
  std::vector<double> ratios;
  for (std::size_t k = 0; k < repeat; ++k) ratios.push_back(pread[k] / read[k]);
  return {fmt::format("read_raw_{}", threads == 1 ? "1" : "all"),
          fmt::format("raw chunks with checksums / pread, {} thread{}", core::thread_count(),
                      core::thread_count() == 1 ? "" : "s"),
          "x",
          spread(ratios),
          Target{Target::Kind::at_least, 0.8},
          fmt::format("{} / {}", speed(job.bytes(), read), speed(job.bytes(), pread))};
}

Row zstd_row(const std::string& path, std::size_t threads, std::size_t repeat) {
  const core::ThreadLimit limit(threads);
  Job job(path, all_channels(path));
  std::vector<double> speeds;
  job.read();
  for (std::size_t k = 0; k < repeat; ++k) {
    speeds.push_back(job.bytes() / 1e9 / seconds_of([&] { job.read(); }));
  }
  return {fmt::format("read_zstd_{}", threads == 1 ? "1" : "all"),
          fmt::format("zstd chunks, decoded, {} thread{}", core::thread_count(),
                      core::thread_count() == 1 ? "" : "s"),
          "GB/s",
          spread(speeds),
          {},
          fmt::format("{:.0f} MB", job.bytes() / 1e6)};
}

Row three_row(const std::string& path, std::size_t repeat) {
  const core::ThreadLimit limit(1);
  Job some(path, three_channels(path)), all(path, all_channels(path));
  const auto [three, whole] = in_turn(
      repeat, [&] { some.read(); }, [&] { all.read(); });
  const double share = some.bytes() / all.bytes();
  std::vector<double> ratios;
  for (std::size_t k = 0; k < repeat; ++k) ratios.push_back(three[k] / whole[k] / share);
  return {"read_three",
          "three channels / all: time over bytes, 1 thread",
          "x",
          spread(ratios),
          Target{Target::Kind::at_most, 1.25},
          fmt::format("{:.0f} of {:.0f} MB", some.bytes() / 1e6, all.bytes() / 1e6)};
}

}  // namespace

std::vector<Row> read_rows(const std::string& raw, const std::string& zstd, std::size_t repeat) {
  return {raw_row(raw, 1, repeat), raw_row(raw, 0, repeat), zstd_row(zstd, 1, repeat),
          zstd_row(zstd, 0, repeat), three_row(raw, repeat)};
}

Row open_row(const std::string& path, std::size_t repeat) {
  write_sparse(path);
  std::vector<double> seconds;
  std::uint64_t bytes = 0;
  for (std::size_t k = 0; k < repeat; ++k) {
    seconds.push_back(seconds_of([&] { bytes = formats::Reader(path).file_bytes(); }));
  }
  return {"open_200gb",
          "opening a sparse file through its index",
          "s",
          spread(seconds),
          Target{Target::Kind::at_most, 1},
          fmt::format("{:.0f} GB, 50,000 chunks", static_cast<double>(bytes) / 1e9)};
}

}  // namespace psf::bench
