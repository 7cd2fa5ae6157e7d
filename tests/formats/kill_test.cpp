// A writer is killed again and again while a reader reads: committed records only grow, and every
// value is right.
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>
#include <random>
#include <thread>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

// psf_numbered_writer as a process; its constructor returns when it is about to open the file.
class WriterProcess {
 public:
  explicit WriterProcess(std::vector<std::string> arguments) {
    std::string program = PSF_BINARY_DIR "/psf_numbered_writer";
    std::vector<char*> pointers = {program.data()};
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    int ends[2] = {};
    REQUIRE(::pipe2(ends, O_CLOEXEC) == 0);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    const int failed =
        ::posix_spawn(&process_, pointers[0], &actions, nullptr, pointers.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    REQUIRE(failed == 0);
    output_ = ends[0];
    char ready[6];
    CHECK(::read(output_, ready, sizeof ready) == 6);
  }
  ~WriterProcess() { ::close(output_); }
  WriterProcess(const WriterProcess&) = delete;
  WriterProcess& operator=(const WriterProcess&) = delete;

  void kill() const { ::kill(process_, SIGKILL); }

  // The exit code, or minus the signal that ended it.
  [[nodiscard]] int wait() const {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  pid_t process_ = 0;
  int output_ = -1;
};

// Opens the file again and again, or refreshes, and judges what it sees.
class Watcher {
 public:
  explicit Watcher(std::string path) : path_(std::move(path)), thread_([this] { watch(); }) {}

  void stop() {
    done_ = true;
    thread_.join();
  }

  std::atomic<std::uint64_t> looks = 0;
  std::uint64_t grown = 0, wrong = 0, shrunk = 0, passes = 0;
  std::vector<std::string> errors;

 private:
  void watch() {
    std::mt19937 random(9);
    std::optional<Reader> reader;
    while (!done_) {
      try {
        if (!reader || random() % 2 == 0) {
          reader.emplace(path_);
        } else {
          static_cast<void>(reader->refresh());
        }
        judge(*reader, random());
      } catch (const Error& error) {
        // It is not there before its first pass.
        if (passes > 0 || error.code() != ErrorCode::io) errors.push_back(error.what());
      }
    }
  }

  void judge(const Reader& reader, std::uint64_t random) {
    ++looks;
    const std::uint64_t now = reader.passes().size();
    if (now < passes || reader.records() != now * test::kNumberedPass) ++shrunk;
    if (now > passes) ++grown;
    // What is new, and a pass from anywhere.
    const std::uint64_t fresh = now > passes ? passes : now - 1;
    judge_passes(reader, fresh, now);
    judge_passes(reader, random % now, random % now + 1);
    passes = std::max(passes, now);
  }

  void judge_passes(const Reader& reader, std::uint64_t first, std::uint64_t last) {
    const std::uint64_t from = first * test::kNumberedPass;
    const auto numbers = test::numbers_from(from, (last - first) * test::kNumberedPass);
    for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
      test::Bytes values(numbers.size() * reader.head().channels[k].stride());
      reader.read(k, from, numbers.size(), values);
      if (values != test::numbered_values(k, numbers)) ++wrong;
    }
  }

  std::string path_;
  std::atomic<bool> done_ = false;
  std::thread thread_;
};

void kill_writers(int kills, Codec codec) {
  const test::Scratch scratch;
  const std::string path = scratch.path("k.pvb");
  const std::string codec_name = codec == Codec::raw ? "raw" : "zstd";
  std::mt19937 random(codec == Codec::raw ? 11 : 12);
  Watcher watcher(path);
  const auto passes_now = [&]() -> std::uint64_t {
    return std::filesystem::exists(path) ? Reader(path).passes().size() : 0;
  };
  constexpr long kLongest = 20'000;  // microseconds
  int killed = 0;
  std::uint64_t before = 0, lost = 0;
  for (int k = 0; k < kills; ++k) {
    // At most 60 passes a life, so that the file stays small; now and then as fast as it can.
    const std::string last = std::to_string(before + 60);
    const WriterProcess writer(
        {path, codec_name, last, k % 3 == 0 ? "0" : "300", k % 4 == 0 ? "sync" : "nosync"});
    // Every other life lasts until it has committed a pass, however slow the machine is; the others
    // end anywhere, before the file is open too.
    while (k % 2 == 0 && passes_now() == before) std::this_thread::yield();
    std::this_thread::sleep_for(
        std::chrono::microseconds(static_cast<long>(random() >> 1) % kLongest));
    writer.kill();
    killed += writer.wait() == -SIGKILL;
    const std::uint64_t now = passes_now();
    if (now < before) ++lost;
    before = now;
  }
  const std::uint64_t total = before + 1;
  const WriterProcess last({path, codec_name, std::to_string(total), "0", "nosync", "close"});
  CHECK(last.wait() == 0);
  while (watcher.looks <= 10) std::this_thread::yield();
  watcher.stop();
  CAPTURE(kills, before, watcher.looks.load(), watcher.grown, watcher.errors);
  CHECK(killed == kills);
  CHECK(lost == 0);
  CHECK(watcher.errors.empty());
  CHECK(watcher.wrong == 0);
  CHECK(watcher.shrunk == 0);
  CHECK(watcher.grown > 0);
  CHECK(before >= static_cast<std::uint64_t>(kills) / 2);  // it got on

  const Reader reader(path);
  CHECK(reader.closed());
  CHECK(test::holds_passes(reader, total));
  const std::vector<Fault> faults = check(path).faults;
  CHECK(faults.empty());
  CHECK_FALSE(std::filesystem::exists(path + ".partial"));
  // Chunk by chunk the same as of one that was never stopped.
  test::write_numbered_file(scratch.path("whole.pvb"), codec, total);
  const Reader whole(scratch.path("whole.pvb"));
  CHECK(whole.chunks().size() == reader.chunks().size());
  std::size_t different = 0;
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    different += test::read_all(reader, k) != test::read_all(whole, k);
  }
  CHECK(different == 0);
  CHECK(reader.resume_state() == whole.resume_state());
}

}  // namespace

TEST_CASE("a writer that is killed again and again loses nothing that it committed") {
  kill_writers(13, Codec::raw);
  kill_writers(12, Codec::zstd);
}

TEST_CASE("a writer that is killed 300 times loses nothing that it committed", "[.][long]") {
  kill_writers(200, Codec::raw);
  kill_writers(200, Codec::zstd);
}
