#include "formats/write/writer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "core/error.h"
#include "formats/layout/codec.h"
#include "formats/write/appender.h"

namespace psf::formats {

struct Writer::State {
  State(std::unique_ptr<Appender> to, const WriterOptions& writer_options)
      : file(std::move(to)), codec(writer_options.codec), pending(head().table_count()) {
    for (std::size_t k = 0; k < pending.size(); ++k) {
      pending[k].columns.resize(head().schema(k).channels.size());
    }
  }

  [[nodiscard]] const Head& head() const { return file->head(); }
  [[nodiscard]] const std::string& path() const { return file->path(); }

  // The first error of any call sticks.
  template <class Call>
  void guard(const Call& call) {
    if (error) throw Error(*error);
    if (!file->is_open()) throw Error(ErrorCode::usage, path() + ": is closed already");
    try {
      call();
    } catch (const Error& first) {
      error = first;
      throw;
    } catch (const std::bad_alloc&) {
      error = Error(ErrorCode::limit, path() + ": out of memory; use smaller chunks");
      throw Error(*error);
    }
  }

  void append(std::size_t table, std::size_t count, std::span<const void* const> columns) {
    const Schema& schema = head().schema(table);
    if (columns.size() != schema.channels.size()) {
      throw Error(ErrorCode::usage, fmt::format("{}: {} columns given for {} channels", path(),
                                                columns.size(), schema.channels.size()));
    }
    Pending& held = pending[table];
    std::size_t done = 0;
    while (done < count) {
      const std::size_t capacity = schema.chunk_capacity;
      if (held.count == 0 && count - done >= capacity) {
        const std::size_t most =
            std::max<std::size_t>(1, kBatchBytes / (capacity * schema.stride()));
        const std::size_t chunks = std::min(most, (count - done) / capacity);
        write_chunks(table, chunks, capacity, [&](std::size_t channel) {
          return static_cast<const std::byte*>(columns[channel]) +
                 done * schema.channels[channel].stride();
        });
        done += chunks * capacity;
        continue;
      }
      const std::size_t taken = std::min(count - done, capacity - held.count);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        const std::size_t stride = schema.channels[k].stride();
        const auto* from = static_cast<const std::byte*>(columns[k]) + done * stride;
        held.columns[k].insert(held.columns[k].end(), from, from + taken * stride);
      }
      held.count += taken;
      done += taken;
      if (held.count == capacity) flush(table);
    }
  }

  void flush(std::size_t table) {
    Pending& held = pending[table];
    if (held.count == 0) return;
    write_chunks(table, 1, held.count,
                 [&](std::size_t channel) { return held.columns[channel].data(); });
    for (auto& column : held.columns) column.clear();
    held.count = 0;
  }

  [[nodiscard]] bool has_pending() const {
    return std::any_of(pending.begin(), pending.end(),
                       [](const Pending& held) { return held.count > 0; });
  }

  // Encodes columns of chunks of `count` records each in parallel and writes the chunks in order.
  template <class Data>
  void write_chunks(std::size_t table, std::size_t chunks, std::size_t count, const Data& data) {
    const Schema& schema = head().schema(table);
    const std::size_t channels = schema.channels.size();
    const std::size_t jobs = chunks * channels;
    if (encoded.size() < jobs) encoded.resize(jobs);
    if (storage.size() < jobs) storage.resize(jobs);
    tbb::parallel_for(std::size_t{0}, jobs, [&](std::size_t job) {
      const std::size_t channel = job % channels;
      const std::size_t bytes = count * schema.channels[channel].stride();
      const std::byte* from = data(channel) + job / channels * bytes;
      encoded[job] = encode_column(codec, {from, bytes}, storage[job]);
    });
    for (std::size_t k = 0; k < chunks; ++k) {
      file->add_chunk(table, static_cast<std::uint32_t>(count),
                      std::span(encoded).subspan(k * channels, channels));
    }
  }

  // The chunk of a table that is being filled: a column each, of so many records.
  struct Pending {
    std::vector<std::vector<std::byte>> columns;
    std::size_t count = 0;
  };

  std::unique_ptr<Appender> file;
  Codec codec;
  std::optional<Error> error;

  std::vector<Pending> pending;  // one a table
  std::vector<EncodedColumn> encoded;
  std::vector<Buffer> storage;
};

Writer::Writer(const std::string& path, const Head& head, const WriterOptions& options)
    : state_(std::make_unique<State>(
          Appender::create(path, head, options, Appender::Appear::first_commit), options)) {}

Writer::Writer(std::unique_ptr<State> state) : state_(std::move(state)) {}

Writer Writer::resume(const std::string& path, const Head& head, const WriterOptions& options) {
  return Writer(std::make_unique<State>(Appender::resume(path, head, options), options));
}

Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&&) noexcept = default;
Writer::~Writer() = default;

void Writer::append(std::size_t count, std::span<const void* const> columns) {
  append_to(0, count, columns);
}

void Writer::append_to(std::size_t table, std::size_t count, std::span<const void* const> columns) {
  state_->guard([&] { state_->append(table, count, columns); });
}

void Writer::commit(std::span<const std::byte> resume_state) {
  state_->guard([&] {
    for (std::size_t k = 0; k < state_->pending.size(); ++k) state_->flush(k);
    state_->file->commit(resume_state);
  });
}

void Writer::close() {
  state_->guard([&] {
    if (state_->has_pending()) {
      throw Error(ErrorCode::usage, state_->path() + ": records were appended but not committed");
    }
    state_->file->close();
  });
}

const std::string& Writer::path() const {
  return state_->path();
}
const Head& Writer::head() const {
  return state_->head();
}
std::uint64_t Writer::records() const {
  return state_->file->records();
}
std::uint64_t Writer::passes() const {
  return state_->file->passes();
}
std::span<const std::byte> Writer::resume_state() const {
  return state_->file->resume_state();
}
std::uint64_t Writer::bytes_written() const {
  return state_->file->bytes();
}

}  // namespace psf::formats
