// What is printed gets out or is an error; what is said is one line.
#include "core/standard_streams.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "catch.h"
#include "core/error.h"
#include "temp_folder.h"

using psf::tests::TempFolder;

namespace {

// Exit code of a process that does this.
int in_a_child(const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int flush_to(const char* path) {
  return in_a_child([path] {
    dup2(open(path, O_WRONLY), STDOUT_FILENO);
    std::fputs("text", stdout);
    try {
      psf::core::flush_standard_output();
    } catch (const psf::Error& error) {
      return static_cast<int>(error.code());
    }
    return 0;
  });
}

}  // namespace

TEST_CASE("text that a full disk does not take is an I/O error") {
  std::fflush(stdout);
  CHECK(flush_to("/dev/full") == 4);
  CHECK(flush_to("/dev/null") == 0);
}

TEST_CASE("no file gets the number of a standard stream") {
  std::fflush(stdout);
  const int lowest = in_a_child([] {
    closefrom(0);  // also what the test itself was given
    psf::core::open_standard_streams();
    char byte = 0;
    const bool fails = read(0, &byte, 1) < 0 && write(1, &byte, 1) < 0 && write(2, &byte, 1) < 0;
    return fails ? open("/dev/null", O_RDONLY) : 0;
  });
  CHECK(lowest == 3);
}

TEST_CASE("what is said is one line, and nothing is thrown where it cannot be") {
  std::fflush(stdout);
  const TempFolder folder;
  const std::string path = folder / "err";
  const auto say_to = [](const std::string& where) {
    return in_a_child([&] {
      dup2(open(where.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
      psf::core::say("a\nb\x1b[2J\xe9");
      return 0;
    });
  };
  CHECK(say_to(path) == 0);
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  CHECK(text == "a\\nb\\x1b[2J\xe9\n");
  CHECK(say_to("/dev/full") == 0);
}
