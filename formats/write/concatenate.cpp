#include "formats/write/concatenate.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <filesystem>
#include <memory>

#include "core/error.h"
#include "formats/layout/chunk.h"
#include "formats/layout/codec.h"
#include "formats/layout/file.h"
#include "formats/layout/quantize.h"
#include "formats/read/reader.h"
#include "formats/write/appender.h"
#include "formats/write/joined_head.h"

namespace psf::formats {
namespace {

struct Input {
  explicit Input(const std::string& path) : reader(path), file(File::open(path)) {}
  Reader reader;
  File file;
  std::uint64_t first = 0, last = 0;  // passes to take
};

// A column on its way, with the memory that it lies in.
struct Work {
  EncodedColumn column;
  Buffer storage;
  std::vector<std::byte> values;      // decoded
  std::vector<std::uint16_t> narrow;  // quantised
};

struct Job {
  const TableReader* from;
  const File* file;
  std::size_t chunk;
  std::vector<Column> columns;  // where they lie

  [[nodiscard]] const ChunkEntry& entry() const { return from->chunks()[chunk]; }
};

// An input may have the name of the output, but not the one that it has while it is written.
void check_not_overwritten(const std::string& path, const std::string& output) {
  std::error_code missing;
  if (!std::filesystem::equivalent(path, Appender::partial_path(output), missing)) return;
  throw Error(
      ErrorCode::usage,
      fmt::format("{}: writing it would overwrite the input {}; give another name", output, path));
}

class Concatenation {
 public:
  Concatenation(std::span<const std::string> paths, const std::string& output,
                const ConcatenateOptions& options)
      : options_(options) {
    for (const std::string& path : paths) {
      check_not_overwritten(path, output);
      inputs_.emplace_back(path);
    }
    select_passes();
    std::vector<JoinedInput> joined;
    for (const Input& input : inputs_) {
      if (input.first < input.last) joined.push_back({input.reader, input.first, input.last});
    }
    head_ = join_heads(joined, options);
    WriterOptions writer_options;
    writer_options.sync = options.sync;
    appender_ = Appender::create(output, head_.head, writer_options, Appender::Appear::published);
  }

  ConcatenateResult run(const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
    std::uint64_t total = 0;
    for (const Input& input : inputs_) {
      for (std::uint64_t p = input.first; p < input.last; ++p)
        total += input.reader.passes()[p].count;
    }
    for (const Input& input : inputs_) {
      std::vector<std::size_t> next(head_.tables.size());  // chunk of each table
      for (std::uint64_t pass = input.first; pass < input.last; ++pass) {
        for (std::size_t k = 0; k < head_.tables.size(); ++k) {
          next[k] = copy_pass(input, k, pass, next[k], [&] {
            if (progress) progress(appender_->appended(), total);
          });
        }
        end_pass(input, pass);
      }
    }
    appender_->close();
    appender_->publish();
    return {appender_->records(), appender_->passes(), appender_->bytes(), overflows_, head_.notes};
  }

 private:
  // Copies the chunks that a table has of a pass; `chunk` is none behind their first. Returns the
  // chunk behind their last.
  template <class Progress>
  std::size_t copy_pass(const Input& input, std::size_t table, std::uint64_t pass,
                        std::size_t chunk, const Progress& progress) {
    const TableReader& from = input.reader.table(head_.tables[table].source);
    const std::span<const ChunkEntry> chunks = from.chunks();
    while (chunk < chunks.size() && chunks[chunk].pass < pass) ++chunk;
    for (; chunk < chunks.size() && chunks[chunk].pass == pass; ++chunk) {
      jobs_.push_back({&from, &input.file, chunk, from.columns(chunk)});
      if (jobs_.size() < batch_size(table)) continue;
      write_batch(table);
      progress();
    }
    write_batch(table);
    progress();
    return chunk;
  }

  void select_passes() {
    std::uint64_t all = 0;
    for (const Input& input : inputs_) all += input.reader.passes().size();
    const std::uint64_t last = options_.last_pass.value_or(all);
    if (options_.first_pass >= last || last > all) {
      throw Error(ErrorCode::usage, fmt::format("passes {}:{} are no part of the {} that there are",
                                                options_.first_pass, last, all));
    }
    std::uint64_t before = 0;
    for (Input& input : inputs_) {
      const std::uint64_t passes = input.reader.passes().size();
      const auto within = [&](std::uint64_t pass) {
        return std::clamp(pass, before, before + passes) - before;
      };
      input.first = within(options_.first_pass);
      input.last = within(last);
      before += passes;
    }
  }

  [[nodiscard]] std::size_t batch_size(std::size_t table) const {
    const Schema& schema = head_.head.schema(table);
    return std::max<std::size_t>(1, kBatchBytes / (schema.chunk_capacity * schema.stride()));
  }

  void write_batch(std::size_t table) {
    const std::vector<JoinedChannel>& joined = head_.tables[table].channels;
    const std::size_t channels = joined.size();
    if (work_.size() < jobs_.size() * channels) work_.resize(jobs_.size() * channels);
    tbb::parallel_for(std::size_t{0}, jobs_.size() * channels, [&](std::size_t k) {
      convert(jobs_[k / channels], joined[k % channels], work_[k]);
    });
    for (std::size_t k = 0; k < jobs_.size(); ++k) {
      std::vector<EncodedColumn> columns;
      for (std::size_t c = 0; c < channels; ++c) columns.push_back(work_[k * channels + c].column);
      appender_->add_chunk(table, jobs_[k].entry().count, columns);
    }
    jobs_.clear();
  }

  void convert(const Job& job, const JoinedChannel& joined, Work& work) {
    const TableReader& reader = *job.from;
    const ChunkEntry& entry = job.entry();
    const Column& column = job.columns[joined.source];
    if (!joined.quantized && column.codec == options_.codec.value_or(column.codec)) {
      try {
        work.column = read_stored(*job.file, entry.offset, column, work.storage);
      } catch (const Error& error) {
        if (error.code() == ErrorCode::io) throw;
        throw Error(
            error.code(),
            fmt::format("{}: {}chunk {} ({}): channel {}: {}; 'psf recover' saves the rest",
                        job.file->path(), reader.prefix(), job.chunk,
                        record_range(entry.first, entry.count), joined.channel.name, error.what()));
      }
      return;
    }
    const Codec codec = options_.codec.value_or(column.codec);
    work.values.resize(entry.count * reader.schema().channels[joined.source].stride());
    reader.read(joined.source, entry.first, entry.count, work.values);
    if (!joined.quantized) {
      work.column = encode_column(codec, work.values, work.storage);
      return;
    }
    quantize(joined.channel, work);
    work.column = encode_column(codec, std::as_bytes(std::span(work.narrow)), work.storage);
  }

  // `values`, f32, into `narrow`.
  void quantize(const Channel& to, Work& work) {
    const std::span<const float> values(
        static_cast<const float*>(static_cast<const void*>(work.values.data())),
        work.values.size() / sizeof(float));
    if (to.encoding == Encoding::octahedral) {
      work.narrow.resize(values.size() / 3 * 2);
      return encode_octahedral(values, work.narrow);
    }
    work.narrow.resize(values.size());
    encode_half(values, work.narrow);
    std::uint64_t overflows = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      constexpr std::uint16_t kInfinity = 0x7C00;
      if ((work.narrow[i] & 0x7FFF) == kInfinity && std::isfinite(values[i])) ++overflows;
    }
    overflows_ += overflows;
  }

  void end_pass(const Input& input, std::uint64_t pass) {
    const bool same = inputs_.size() == 1 && input.first == 0 &&
                      input.last == input.reader.passes().size() && pass + 1 == input.last;
    appender_->commit(same ? input.reader.resume_state() : std::vector<std::byte>());
  }

  ConcatenateOptions options_;
  std::deque<Input> inputs_;
  JoinedHead head_;
  std::unique_ptr<Appender> appender_;
  std::vector<Job> jobs_;
  std::vector<Work> work_;
  std::atomic<std::uint64_t> overflows_{0};
};

}  // namespace

ConcatenateResult concatenate(std::span<const std::string> inputs, const std::string& output,
                              const ConcatenateOptions& options,
                              const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  return Concatenation(inputs, output, options).run(progress);
}

}  // namespace psf::formats
