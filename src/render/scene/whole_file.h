// Reads whole files.
#pragma once

#include <fstream>
#include <string>

namespace psf::render {

// Opens a regular file for reading and returns its size in bytes. Throws Error{io} "FILE: what",
// also for a folder and for a pipe, since a scene may be read more than once.
[[nodiscard]] std::size_t open_whole(const std::string& path, std::ifstream& file);
// Throws Error{io} where the file was not read completely.
void check_read(const std::string& path, const std::ifstream& file);

// All bytes of a file, as a std::string or a vector of bytes.
template <class Bytes>
[[nodiscard]] Bytes read_whole(const std::string& path) {
  std::ifstream file;
  Bytes bytes(open_whole(path, file), {});
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  check_read(path, file);
  return bytes;
}

}  // namespace psf::render
