// Runs a program of ours under limits of the system, as batch queues and full disks set them.
#pragma once

#include <fcntl.h>
#include <grp.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <functional>
#include <string>

#include "command.h"

namespace psf::tests {

// What a program meets; called in its process before it starts.
using Confinement = std::function<void()>;

inline void limit(int resource, rlim_t most) {
  const rlimit limits{most, most};
  setrlimit(static_cast<decltype(RLIMIT_AS)>(resource), &limits);
}

// A program that spins is ended by the CPU time that it takes, however busy the machine is.
inline void limit_cpu(rlim_t seconds) {
  const rlimit limits{seconds, seconds};
  setrlimit(RLIMIT_CPU, &limits);
}

// Nobody else's processes count against the limits of this user, and root has none.
inline void become_somebody() {
  if (geteuid() != 0) return;
  const auto id = static_cast<uid_t>(100'000 + getpid());
  if (setgroups(0, nullptr) != 0 || setgid(id) != 0 || setuid(id) != 0) _exit(125);
}

inline void redirect(int descriptor, const char* path) {
  const int file = open(path, O_RDWR);
  if (file < 0 || dup2(file, descriptor) < 0) _exit(125);
  if (file != descriptor) close(file);
}

// A pipe that nobody reads any more.
inline void close_pipe_of(int descriptor) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0 || dup2(ends[1], descriptor) < 0) _exit(125);
  close(ends[0]);
  close(ends[1]);
}

// As run() of command.h; what the program says comes through pipes, which have no limit of size.
inline Outcome run_confined(const std::string& command, const Confinement& confine) {
  std::array<int, 2> out{}, err{};
  if (pipe(out.data()) != 0 || pipe(err.data()) != 0) return {};
  const std::string line = "PATH=" PSF_BINARY_DIR ":\"$PATH\"; exec " + command;
  const pid_t child = fork();
  if (child == 0) {
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    closefrom(STDERR_FILENO + 1);  // also what the test itself was given: limits count open files
    redirect(STDIN_FILENO, "/dev/null");
    confine();
    execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
    _exit(126);
  }
  close(out[1]);
  close(err[1]);
  Outcome outcome;
  const auto drain = [](int end, std::string& text) {
    std::array<char, 4096> bytes{};
    for (ssize_t got = 0; (got = read(end, bytes.data(), bytes.size())) > 0;) {
      text.append(bytes.data(), static_cast<std::size_t>(got));
    }
    close(end);
  };
  drain(out[0], outcome.out);
  drain(err[0], outcome.err);
  int status = 0;
  waitpid(child, &status, 0);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

}  // namespace psf::tests
