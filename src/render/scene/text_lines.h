// Reads the statements of OBJ and MTL files, line by line and word by word.
#pragma once

#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "render/scene/scene.h"

namespace psf::render {

// A byte order mark is skipped. Lines end with LF, CR LF or CR; a backslash at the end of a line
// continues it. Text that is not UTF-8 is read as Latin-1 and becomes UTF-8, so that names in files
// of either kind agree.
class TextLines {
 public:
  // Reads the whole file. Throws Error{io} where it cannot be read, Error{bad_input} where it is
  // UTF-16.
  explicit TextLines(const std::string& path);

  // Goes on to the next line that is neither empty nor a comment; false at the end.
  bool next();
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::size_t line() const { return line_; }  // from 1
  [[nodiscard]] std::string_view statement() const { return statement_; }

  // The next word, empty at the end of the line or at a comment.
  std::string_view word();
  // The rest of the line, without white space around it, for names, which may hold spaces and #.
  [[nodiscard]] std::string_view rest() const;
  // Drops `count` characters of rest().
  void skip(std::size_t count);

  // The next word as a number. Throws Error{bad_input} where there is no number, or none that is
  // finite in single precision. The message names `kind` and, where it is above 0, `index`: "vertex
  // 3".
  float number(std::string_view kind, std::size_t index = 0);
  // The same for a word already read.
  [[nodiscard]] float to_number(std::string_view word, std::string_view kind,
                                std::size_t index = 0) const;
  // The same in double.
  [[nodiscard]] double to_real(std::string_view word, std::string_view kind,
                               std::size_t index = 0) const;
  // Whether `word` is a number and nothing else.
  [[nodiscard]] static bool is_number(std::string_view word);

  // Throws Error{bad_input} "FILE:LINE: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  [[nodiscard]] std::size_t find_line_end(std::size_t from) const;

  std::string path_, text_;
  std::size_t at_ = 0;     // place in text_ where the next line starts
  std::size_t line_ = 0;   // line of the statement
  std::size_t lines_ = 0;  // number of lines before at_
  std::string_view statement_, rest_;
};

// The names of everything in a file that has no effect on the picture, each once.
class LeftOut {
 public:
  void add(std::string_view name);
  // Adds the name of a statement without effect.
  void add_statement(std::string_view statement);
  // Adds one warning that names everything left out; none where nothing is.
  void warn(const std::string& path, Scene& scene) const;

 private:
  std::vector<std::string> names_;  // the first few names, in their order
  std::set<std::string, std::less<>> all_;
};

// The first spelling of `name` with which find_file() finds a file: as it is, without quotes around
// it, with "\ " replaced by a space, or with the bytes that it had in Latin-1. Empty where none
// succeeds.
[[nodiscard]] std::string find_named(const std::string& beside, std::string_view name);

}  // namespace psf::render
