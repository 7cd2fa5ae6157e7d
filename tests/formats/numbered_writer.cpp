// A writer for the tests to kill or to starve: adds numbered passes to a file, new or resumed.
//
//   psf_numbered_writer FILE raw|zstd LAST PAUSE sync|nosync [close]
//
// LAST: passes in the end. PAUSE: microseconds at most between two steps. Says "ready" before it
// opens the file, and the passes that it has committed at the end; without "close" it then waits to
// be killed. Exit codes are those of psf::Error, the message goes to stderr.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>

#include "core/error.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

Writer open_writer(const std::string& path, const WriterOptions& options) {
  if (std::filesystem::exists(path)) return Writer::resume(path, test::numbered_head(), options);
  return Writer(path, test::numbered_head(), options);
}

void write_pass(Writer& writer, unsigned pause) {
  static std::mt19937 random(static_cast<unsigned>(::getpid()));
  const auto rest = [&] {
    if (pause > 0) ::usleep(static_cast<useconds_t>(random() % pause));
  };
  const std::uint64_t first = writer.passes() * test::kNumberedPass;
  for (std::size_t done = 0; done < test::kNumberedPass;) {
    const std::size_t count = std::min<std::size_t>(1 + random() % 30, test::kNumberedPass - done);
    test::append_numbered(writer, first + done, count);
    done += count;
    rest();
  }
  const std::string state = test::numbered_state(writer.passes() + 1);
  writer.commit(std::as_bytes(std::span(state)));
  rest();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) return 2;
  const std::string path = argv[1];
  const std::uint64_t last = std::strtoull(argv[3], nullptr, 10);
  const auto pause = static_cast<unsigned>(std::atoi(argv[4]));
  const WriterOptions options{
      argv[2] == std::string("raw") ? Codec::raw : Codec::zstd, argv[5] == std::string("sync"), {}};
  std::uint64_t passes = 0;
  try {
    std::printf("ready\n");
    std::fflush(stdout);
    Writer writer = open_writer(path, options);
    passes = writer.passes();
    while (writer.passes() < last) {
      write_pass(writer, pause);
      passes = writer.passes();
    }
    if (argc > 6) {
      writer.close();
    } else {
      ::pause();
    }
    std::printf("%llu\n", static_cast<unsigned long long>(passes));
    return 0;
  } catch (const Error& error) {
    std::printf("%llu\n", static_cast<unsigned long long>(passes));
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code());
  }
}
