// ^C sets a flag that long work looks at; a second one ends the program at once and leaves nothing
// unfinished.
#include "core/interrupt.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <functional>
#include <thread>

#include "catch.h"
#include "core/error.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "temp_folder.h"

using psf::core::OutputFile;
using psf::tests::TempFolder;

namespace {

struct End {
  int code = -1, signal = 0;
};

// How a process ends that watches interrupts and does this.
End in_a_process(const std::function<void()>& work) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    for (int signal = 1; signal < SIGRTMIN; ++signal) std::signal(signal, SIG_DFL);  // not Catch2's
    psf::core::watch_interrupts();
    work();
    _exit(77);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? End{WEXITSTATUS(status), 0} : End{-1, WTERMSIG(status)};
}

// One that comes later than what counts as the same.
void raise_later(int signal) {
  usleep(60'000);
  std::raise(signal);
}

}  // namespace

TEST_CASE("the first interrupt is noted and becomes exit code 130 where work can end") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) {
    const End end = in_a_process([signal] {
      if (psf::core::interrupted()) return;
      psf::core::throw_if_interrupted("nothing is lost");
      std::raise(signal);
      if (!psf::core::interrupted()) return;
      try {
        psf::core::throw_if_interrupted("nothing is lost");
      } catch (const psf::Error& error) {
        const bool right = std::string(error.what()) == "interrupted: nothing is lost";
        _exit(right ? static_cast<int>(error.code()) : 1);
      }
    });
    CHECK(end.code == 130);
  }
}

TEST_CASE("a second interrupt ends the program wherever it is, and removes what is unfinished") {
  const TempFolder folder;
  for (const int first : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) {
    for (const int second : {SIGINT, SIGTERM, SIGHUP}) {
      const End end = in_a_process([&] {
        const OutputFile file(folder / "out.exr");
        std::ofstream(file.temporary_path()) << "half";
        std::raise(first);
        raise_later(second);
      });
      CHECK(end.code == 130);
      CHECK(folder.file_count() == 0);
    }
  }
}

TEST_CASE("one interrupt that is sent twice at once is one") {
  const End end = in_a_process([] {
    std::raise(SIGTERM);
    std::raise(SIGTERM);
    std::raise(SIGXCPU);
  });
  CHECK(end.code == 77);
}

TEST_CASE("nohup holds") {
  const End end = in_a_process([] {
    std::signal(SIGHUP, SIG_IGN);
    psf::core::watch_interrupts();
    std::raise(SIGHUP);
    if (!psf::core::interrupted()) _exit(0);
  });
  CHECK(end.code == 0);
}

TEST_CASE("other signals end the program as they do, and nothing unfinished stays") {
  const TempFolder folder;
  for (const int signal : {SIGQUIT, SIGABRT, SIGSEGV, SIGBUS, SIGUSR1, SIGALRM}) {
    const End end = in_a_process([&] {
      const OutputFile file(folder / "out.exr");
      std::raise(signal);
    });
    CHECK(end.signal == signal);
    CHECK(folder.file_count() == 0);
  }
}

TEST_CASE("a write that is refused ends nothing") {
  const End end = in_a_process([] {
    std::raise(SIGXFSZ);
    std::raise(SIGPIPE);
    _exit(0);
  });
  CHECK(end.code == 0);
}

TEST_CASE("the work of one thread ends where it is told to, that of the others goes on") {
  std::atomic<bool> stopped{false};
  CHECK(!psf::core::interrupted());
  {
    const psf::core::Interruptible here(stopped);
    CHECK(!psf::core::interrupted());
    stopped = true;
    CHECK(psf::core::interrupted());
    CHECK_THROWS_AS(psf::core::throw_if_interrupted("nothing is lost"), psf::Error);
    bool other = true;
    std::thread([&other] { other = psf::core::interrupted(); }).join();
    CHECK(!other);
  }
  CHECK(!psf::core::interrupted());
}

TEST_CASE("a step is overdue a second after its interruption") {
  using namespace std::chrono_literals;
  std::atomic<bool> stopped{false};
  CHECK(!psf::core::overdue());
  {
    const psf::core::Interruptible here(stopped);
    CHECK(!psf::core::overdue());
    stopped = true;
    CHECK(!psf::core::overdue());
    std::this_thread::sleep_for(1100ms);
    CHECK(psf::core::overdue());
  }
  CHECK(!psf::core::overdue());
  psf::core::interrupt();
  CHECK(!psf::core::overdue());
  std::this_thread::sleep_for(1100ms);
  CHECK(psf::core::overdue());
  psf::core::clear_interrupt();
  CHECK(!psf::core::overdue());
}

TEST_CASE("bodies of a parallel loop are interrupted as its caller is") {
  std::atomic<bool> stopped{true};
  std::atomic<int> interrupted{0}, strangers{0};
  const auto count = [&](std::atomic<int>& found) {
    psf::core::parallel_for(64, 1, [&](std::size_t, std::size_t) {
      found += psf::core::interrupted() ? 1 : 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    });
  };
  const psf::core::ThreadLimit four(4);
  {
    const psf::core::Interruptible here(stopped);
    count(interrupted);
  }
  CHECK(interrupted == 64);
  count(strangers);
  CHECK(strangers == 0);
}
