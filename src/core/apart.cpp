#include "core/apart.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <optional>
#include <tuple>

#include "core/error.h"
#include "core/output_file.h"

namespace psf::core {
namespace {

// What identifies a file: for an existing file its device and its inode; else those of its folder,
// and its name; where the folder does not exist either, the whole path.
using Identity = std::tuple<dev_t, ino_t, std::string>;

// The identity of a file; nothing for devices and pipes.
std::optional<Identity> identity_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) return {};
    return Identity(status.st_dev, status.st_ino, "");
  }
  std::filesystem::path target(followed(path));
  if (!target.has_filename()) target = target.parent_path();  // "folder/"
  const std::string folder = (target.parent_path() / ".").string();
  if (::stat(folder.c_str(), &status) != 0) {  // a folder that is to be made
    std::error_code error;
    const auto whole = std::filesystem::weakly_canonical(std::filesystem::absolute(target), error);
    return Identity(0, 0, whole.string());
  }
  return Identity(status.st_dev, status.st_ino, target.filename().string());
}

std::optional<Identity> identity_of(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return Identity(status.st_dev, status.st_ino, "");
}

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::usage, why);
}

}  // namespace

void check_apart(std::span<const std::string> inputs, std::span<const std::string> outputs) {
  std::map<Identity, std::string> read, written;
  const auto output = identity_of(STDOUT_FILENO);
  for (const std::string& path : inputs) {
    const auto identity = path.empty() ? std::nullopt : identity_of(path);
    if (!identity) continue;
    if (identity == output) refuse(path + ": is an input, and standard output is redirected to it");
    read.emplace(*identity, path);
  }
  for (const std::string& path : outputs) {
    const auto identity = path.empty() ? std::nullopt : identity_of(path);
    if (!identity) continue;
    if (identity == output) {
      refuse(path +
             ": standard output, which takes the results as text, is redirected to it; give "
             "another name");
    }
    if (const auto found = read.find(*identity); found != read.end()) {
      refuse(path + ": writing it would overwrite the input " + found->second +
             "; give another name");
    }
    const auto [other, is_new] = written.emplace(*identity, path);
    if (!is_new) {
      refuse(path + ": is written twice" +
             (other->second == path ? "" : ", also as " + other->second) +
             "; give each output a name of its own");
    }
  }
}

void check_files(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs) {
  check_apart(inputs, outputs);
  for (const std::string& path : outputs) {
    if (!path.empty()) const OutputFile probe(path);
  }
}

}  // namespace psf::core
