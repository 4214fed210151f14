#pragma once
/// \file Files as bytes, text as numbered lines of words.

#include <string>
#include <string_view>
#include <vector>

namespace vasohex {

/// Throws Error(bad_input) if the file cannot be opened, or is a directory.
std::string file_bytes(const std::string& path);

/// ASCII letters in lower case.
std::string lower_case(std::string_view text);

/// The extension of a file in lower case, with its dot: `.stl`; empty if there is none.
std::string lower_extension(const std::string& path);

/// Walks over the lines of a text that hold words. The text must outlive it.
class TextLines {
 public:
  /// `comment`: from this character on a line is not read; 0: none.
  explicit TextLines(std::string_view text, char comment = 0) : text_(text), comment_(comment) {}

  /// Goes to the next line with words; false at the end of the text.
  bool next();
  /// Of the current line, from 1.
  int number() const { return number_; }
  const std::vector<std::string_view>& words() const { return words_; }
  /// Where the line after the current one begins, in bytes.
  std::size_t end() const { return begin_; }

  /// Word `w` of the current line as a number; `what` names it in the Error if it is missing or not finite.
  double real(std::size_t w, const char* what) const;
  long long integer(std::size_t w, const char* what) const;

  /// Throws Error(bad_input), `line 12: ...`.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string_view text_;
  char comment_ = 0;
  std::size_t begin_ = 0;
  int number_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace vasohex
