// The system says no: every verb ends with the exit code of the README and one line, leaves nothing
// half-written, and ends at all.
#include <csignal>

#include "catch.h"
#include "confined.h"
#include "every_verb.h"

using namespace psf::tests;

namespace {

constexpr rlim_t kCpuSeconds = 60;  // limit for a verb that takes at most one second

bool has_partial(const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [](const std::string& name) {
    return name.find(".partial") != std::string::npos;
  });
}

}  // namespace

TEST_CASE(
    "what is printed to a full disk, a closed pipe or nowhere is an I/O error of every verb") {
  const VerbInputs inputs;
  struct Sink {
    const char* reason;
    Confinement confine;
  };
  const std::vector<Sink> sinks = {
      {"No space left on device", [] { redirect(STDOUT_FILENO, "/dev/full"); }},
      {"Broken pipe", [] { close_pipe_of(STDOUT_FILENO); }},
      {"Bad file descriptor", [] { close(STDOUT_FILENO); }}};
  std::vector<std::string> commands = every_verb();
  commands.insert(commands.end(), {"psf --version", "psf filter --help", "psf-render --help"});
  for (const std::string& command : commands) {
    inputs.empty();
    REQUIRE(inputs.try_out(command).code == 0);
    const std::vector<std::string> normal = inputs.written();
    for (const Sink& sink : sinks) {
      inputs.empty();
      const Outcome outcome = run_confined(inputs.placed(command), sink.confine);
      INFO(command << "\n" << sink.reason << "\n" << outcome.err);
      CHECK(outcome.code == 4);
      CHECK(outcome.err.find(std::string(": standard output: ") + sink.reason + "\n") !=
            std::string::npos);
      CHECK(is_one_line(outcome.err));
      CHECK(inputs.written() == normal);
    }
  }
}

TEST_CASE("a dump is not written over by text where standard output is closed") {
  const VerbInputs inputs;
  const std::string command = inputs.placed("psf cat IN/a.pvb -o OUT/c.pvb");
  REQUIRE(run(command).code == 0);
  const std::string whole = read_text(inputs.out() + "c.pvb");
  const auto close_all = [] {
    for (const int descriptor : {0, 1, 2}) close(descriptor);
  };
  CHECK(run_confined(command, close_all).code == 4);
  CHECK(run(inputs.placed("psf verify OUT/c.pvb")).code == 0);
  CHECK(read_text(inputs.out() + "c.pvb").size() == whole.size());
}

TEST_CASE("a comparison that fails fails, unless its figures are lost") {
  const VerbInputs inputs;
  REQUIRE(inputs.try_out("psf-render IN/room.json --image OUT/b.exr --passes 1").code == 0);
  const std::string command = inputs.placed("psf compare OUT/b.exr IN/a.exr --max 1e-9");
  CHECK(run(command).code == 1);
  CHECK(run_confined(command, [] { redirect(STDOUT_FILENO, "/dev/full"); }).code == 4);
}

TEST_CASE("remarks that cannot be written end no work") {
  const VerbInputs inputs;
  for (const std::string& command : every_verb()) {
    inputs.empty();
    const Outcome outcome =
        run_confined(inputs.placed(command), [] { redirect(STDERR_FILENO, "/dev/full"); });
    INFO(command);
    CHECK(outcome.code == 0);
  }
}

TEST_CASE("a limit of file sizes is an I/O error that names the file, and no part of one stays") {
  const VerbInputs inputs;
  for (const std::string& command : every_verb()) {
    std::size_t refused = 0;
    for (const rlim_t most : {0u, 1u, 512u, 1024u, 4096u, 16384u, 1u << 20, 1u << 28}) {
      inputs.empty();
      const Outcome outcome = run_confined(inputs.placed(command), [most] {
        limit_cpu(kCpuSeconds);
        limit(RLIMIT_FSIZE, most);
      });
      INFO(command << "\n" << most << " bytes\n" << outcome.err);
      CHECK((outcome.code == 0 || outcome.code == 4));
      CHECK_FALSE(has_partial(inputs.written()));
      if (outcome.code == 0) continue;
      ++refused;
      CHECK(is_one_line(outcome.err));
      CHECK(outcome.err.find(inputs.out()) != std::string::npos);
      CHECK(outcome.err.find("File too large") != std::string::npos);
    }
    INFO(command);
    CHECK(refused >= 2);
    CHECK(refused < 8);
  }
}

// The sanitizers need files, memory and threads of their own, and end a program that has none.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("a limit of open files is an error in one line, and nothing stays") {
  const VerbInputs inputs;
  std::size_t all = 0;
  for (const std::string& command : every_verb()) {
    std::size_t refused = 0;
    for (const rlim_t most : {4u, 5u, 6u, 7u, 8u, 9u, 10u, 11u, 64u}) {
      inputs.empty();
      const Outcome outcome = run_confined(inputs.placed(command), [most] {
        limit_cpu(kCpuSeconds);
        limit(RLIMIT_NOFILE, most);
      });
      INFO(command << "\n" << most << " files\n" << outcome.err);
      CHECK((outcome.code == 0 || outcome.code == 4));
      CHECK_FALSE(has_partial(inputs.written()));
      if (outcome.code == 0) continue;
      ++refused;
      CHECK(is_one_line(outcome.err));
    }
    INFO(command);
    CHECK(refused < 9);
    all += refused;
  }
  CHECK(all >= every_verb().size());  // some need no more than they always have
}

namespace {

constexpr rlim_t kMiB = rlim_t{1} << 20;

// The least address space, in steps of 8 MiB, in which the loader can load a program.
rlim_t loadable(const std::string& program) {
  rlim_t least = 0, enough = 128;
  const auto loads = [&](rlim_t steps) {
    return run_confined(program + " --version", [steps] {
             limit(RLIMIT_AS, steps * 8 * kMiB);
           }).code != 127;
  };
  REQUIRE(loads(enough));
  while (enough - least > 1) {
    const rlim_t middle = (least + enough) / 2;
    (loads(middle) ? enough : least) = middle;
  }
  return enough * 8 * kMiB;
}

// Returns whether it was refused.
bool is_refused_well(const VerbInputs& inputs, const std::string& command,
                     const Confinement& confine) {
  inputs.empty();
  const Outcome outcome = run_confined(inputs.placed(command), [&] {
    limit_cpu(kCpuSeconds);
    confine();
  });
  INFO(command << "\n" << outcome.err);
  CHECK((outcome.code == 0 || outcome.code == 5));
  CHECK_FALSE(has_partial(inputs.written()));
  if (outcome.code == 0) return false;
  CHECK(is_one_line(outcome.err));
  return true;
}

}  // namespace

TEST_CASE("in any address space a verb works, or says in one line that it is too small, and ends") {
  const VerbInputs inputs;
  const rlim_t psf = loadable("psf"), psf_render = loadable("psf-render");
  for (const std::string& command : every_verb()) {
    const rlim_t least = command.starts_with("psf-render") ? psf_render : psf;
    std::size_t refused = 0;
    for (const rlim_t more : {0u, 20u, 100u, 124u, 132u, 150u, 180u, 220u, 300u, 500u, 4096u}) {
      INFO(least / kMiB << " + " << more << " MiB");
      refused += is_refused_well(inputs, command, [&] { limit(RLIMIT_AS, least + more * kMiB); });
    }
    INFO(command);
    CHECK(refused >= 1);
    CHECK(refused < 11);
  }
  const auto most = [&](rlim_t bytes) { return [bytes] { limit(RLIMIT_AS, bytes); }; };
  CHECK(run_confined(inputs.placed("psf info IN/a.pvb"), most(psf + 32 * kMiB)).code == 5);
  CHECK(run_confined(inputs.placed("psf info IN/a.pvb"), most(psf + 4096 * kMiB)).code == 0);
}

TEST_CASE("where threads are few a verb works, or says in one line that there are none, and ends") {
  const VerbInputs inputs;
  std::size_t all = 0;
  for (const std::string& command : every_verb()) {
    std::size_t refused = 0;
    for (const rlim_t most : {1u, 2u, 3u, 4u, 6u, 8u, 256u}) {
      INFO(most << " processes");
      refused += is_refused_well(inputs, command, [most] {
        become_somebody();
        limit(RLIMIT_NPROC, most);
      });
    }
    INFO(command);
    CHECK(refused < 7);
    all += refused;
  }
  CHECK(all >= 1);  // how many need threads is the number of cores' affair
}
#endif
