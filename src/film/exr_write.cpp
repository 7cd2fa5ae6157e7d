// EXR through OpenEXR's core library: single-part, scanline, float32. ISA-L compresses the chunks,
// several at once.
#include <fcntl.h>
#include <openexr.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "film/exr_zip.h"
#include "film/image.h"

namespace psf::film {
namespace {

constexpr std::size_t kLines = 16;  // lines of a chunk, which the format fixes for ZIP

// A file that OpenEXR writes through, so that what the system says of a failure is not lost. Small
// pieces are gathered: a header alone is hundreds, which took longer than the pixels of a small
// picture.
class File {
 public:
  explicit File(const std::string& path) {
    pending_.reserve(kGathered);  // first: what throws here must not leave an open file
    descriptor_ = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) error_ = errno;
  }
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  // What OpenEXR calls; -1 where not all bytes were written.
  static std::int64_t write(exr_const_context_t, void* self, const void* bytes, std::uint64_t size,
                            std::uint64_t offset, exr_stream_error_func_ptr_t) {
    const auto* first = static_cast<const char*>(bytes);
    return static_cast<File*>(self)->write({first, size}, offset) ? static_cast<std::int64_t>(size)
                                                                  : -1;
  }
  void close() {
    flush();
    if (descriptor_ >= 0 && ::close(descriptor_) != 0) error_ = errno;
    descriptor_ = -1;
  }
  [[nodiscard]] int error() const { return error_; }

 private:
  static constexpr std::size_t kGathered = 65536;  // bytes

  bool write(std::span<const char> bytes, std::uint64_t offset) {
    if (offset != offset_ + pending_.size() || pending_.size() + bytes.size() > kGathered) {
      if (!flush()) return false;
      offset_ = offset;
    }
    if (bytes.size() > kGathered) return write_now(bytes);
    pending_.insert(pending_.end(), bytes.begin(), bytes.end());
    return true;
  }
  bool flush() {
    const bool written = write_now(pending_);
    pending_.clear();
    return written;
  }
  // At offset_, which moves on.
  bool write_now(std::span<const char> bytes) {
    while (!bytes.empty()) {
      const ssize_t now =
          pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset_));
      if (now < 0 && errno == EINTR) continue;
      if (now <= 0) {
        error_ = now < 0 ? errno : EIO;
        return false;
      }
      bytes = bytes.subspan(static_cast<std::size_t>(now));
      offset_ += static_cast<std::uint64_t>(now);
    }
    return true;
  }

  int descriptor_ = -1;
  int error_ = 0;
  std::vector<char> pending_;
  std::uint64_t offset_ = 0;  // place in the file of the pending bytes, or of the next bytes
};

class Writer {
 public:
  Writer(const std::string& path, const std::string& temporary) : path_(path), file_(temporary) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.user_data = &file_;
    settings.write_fn = File::write;
    // Otherwise it prints them.
    settings.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
    if (file_.error() != 0) fail(EXR_ERR_WRITE_IO);
    check(exr_start_write(&context_, path.c_str(), EXR_WRITE_FILE_DIRECTLY, &settings));
  }
  ~Writer() {
    if (context_ != nullptr) exr_finish(&context_);
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void write_header(const Image& image) {
    constexpr std::size_t kShortName = 31;  // longer ones take a flag, which old readers refuse
    for (const Layer& layer : image.layers) {
      if (layer.channel.size() > kShortName) check(exr_set_longname_support(context_, 1));
    }
    check(exr_add_part(context_, "", EXR_STORAGE_SCANLINE, &part_));
    check(exr_initialize_required_attr_simple(
        context_, part_, static_cast<std::int32_t>(image.width),
        static_cast<std::int32_t>(image.height), EXR_COMPRESSION_ZIP));
    for (const Layer& layer : image.layers) {
      check(exr_add_channel(context_, part_, layer.channel.c_str(), EXR_PIXEL_FLOAT,
                            EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    }
    for (const auto& [name, value] : image.attributes) {
      check(exr_attr_set_string(context_, part_, name.c_str(), value.c_str()));
    }
    check(exr_write_header(context_));
  }
  void write_chunk(std::size_t line, std::span<const std::uint8_t> bytes) {
    check(exr_write_scanline_chunk(context_, part_, static_cast<int>(line), bytes.data(),
                                   bytes.size()));
  }
  void finish() {
    check(exr_finish(&context_));
    file_.close();
    if (file_.error() != 0) fail(EXR_ERR_WRITE_IO);
  }

 private:
  void check(exr_result_t result) const {
    if (result != EXR_ERR_SUCCESS) fail(result);
  }
  [[noreturn]] void fail(exr_result_t result) const {
    throw Error(result == EXR_ERR_OUT_OF_MEMORY ? ErrorCode::limit : ErrorCode::io,
                path_ + ": cannot write the picture: " +
                    (file_.error() != 0 ? std::strerror(file_.error())
                                        : exr_get_default_error_message(result)));
  }

  std::string path_;
  File file_;
  exr_context_t context_ = nullptr;
  int part_ = 0;
};

// The lines [first, last) as the format has them: of each line all channels in the order of their
// names.
void pack(const Image& image, std::span<const Layer* const> layers, std::size_t first,
          std::size_t last, std::uint8_t* to) {
  const std::size_t row = image.width * sizeof(float);
  for (std::size_t y = first; y < last; ++y) {
    for (const Layer* layer : layers) {
      std::memcpy(to, layer->values.data() + y * image.width, row);
      to += row;
    }
  }
}

// The buffers that no thread uses at the moment. There are never more than threads at work.
class Idle {
 public:
  [[nodiscard]] ExrZip take() {
    const std::scoped_lock lock(mutex_);
    if (zips_.empty()) return {};
    ExrZip zip = std::move(zips_.back());
    zips_.pop_back();
    return zip;
  }
  void give(ExrZip zip) {
    const std::scoped_lock lock(mutex_);
    zips_.push_back(std::move(zip));
  }

 private:
  std::mutex mutex_;
  std::vector<ExrZip> zips_;
};

}  // namespace

void write_exr(const std::string& path, const Image& image) {
  std::vector<const Layer*> layers;
  for (const Layer& layer : image.layers) layers.push_back(&layer);
  std::sort(layers.begin(), layers.end(),
            [](const Layer* a, const Layer* b) { return a->channel < b->channel; });
  core::OutputFile file(path);
  Writer writer(path, file.temporary_path());
  writer.write_header(image);
  const std::size_t chunks = core::range_count(image.height, kLines);
  Idle idle;
  // Few at once: their memory is used again, and fresh memory is what takes long.
  const std::size_t batch = std::min(chunks, 2 * core::thread_count());
  std::vector<std::vector<std::uint8_t>> done(batch);
  for (std::size_t begin = 0; begin < chunks; begin += batch) {
    const std::size_t count = std::min(batch, chunks - begin);
    core::parallel_for(count, 1, [&](std::size_t k, std::size_t) {
      const std::size_t first = (begin + k) * kLines, last = std::min(image.height, first + kLines);
      ExrZip zip = idle.take();
      pack(image, layers, first, last,
           zip.room((last - first) * layers.size() * image.width * sizeof(float)).data());
      const auto bytes = zip.zip();
      done[k].assign(bytes.begin(), bytes.end());
      idle.give(std::move(zip));
    });
    for (std::size_t k = 0; k < count; ++k) writer.write_chunk((begin + k) * kLines, done[k]);
  }
  writer.finish();
  file.commit();
}

}  // namespace psf::film
