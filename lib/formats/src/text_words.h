// Words and numbers of a text from outside, with the line in which they stand.
#pragma once

#include <string>
#include <string_view>

namespace pleat {

class TextWords {
 public:
  explicit TextWords(std::string_view text) : text_(text) {}

  // The next word, over the ends of lines; empty at the end of the text. An opening or closing
  // brace is a word of its own.
  std::string_view Next();
  // What is left of the line, without spaces at its ends and without an opening brace, which stays.
  std::string_view RestOfName();
  // Goes to the next line that is not empty and returns it without spaces at its ends.
  std::string_view NextLine();
  int line() const { return line_; }  // of what was read last, from 1

 private:
  static bool IsSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  void SkipSpace();

  std::string_view text_;
  size_t cursor_ = 0;
  int line_ = 1;
};

// False: the word is not one whole finite number.
bool ParseNumber(std::string_view word, double* value);
// A word for messages: in quotes, short, without control characters.
std::string QuotedWord(std::string_view word);

}  // namespace pleat
