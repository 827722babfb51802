// The lines of an OBJ file, and the words and numbers in them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pleat {

// Goes through a text front to back. A line ends with LF, CR or CR LF. A backslash before its end
// joins it with the next one, for statements that ask for that (ContinueLine) and where no comment
// has begun: a backslash at the end of a comment or of a name belongs to it.
class ObjLines {
 public:
  // A byte order mark at the front is skipped.
  explicit ObjLines(std::string_view text);

  // Goes to the next line; false at the end of the text.
  bool Next();
  // Extends the current line over the lines that its backslashes join.
  void ContinueLine() {
    if (line_end_ > cursor_ && line_end_[-1] == '\\') JoinLines();
  }

  int32_t line() const { return line_; }  // number of the current line, from 1
  // The text from the begin of the current line on.
  std::string_view TextFromLine() const {
    return {line_begin_, static_cast<size_t>(text_end_ - line_begin_)};
  }

  // Each of these begins at the cursor, after spaces.
  bool AtLineEnd() {  // or at a comment
    SkipSpace();
    return AtWordEnd();
  }
  std::string_view Word();
  std::string_view RestOfLine();  // without spaces at its end
  bool ReadFloat(float* value);   // false: no number, too large, or not followed by a space
  // The word at the cursor for messages, in quotes and without control characters.
  std::string Found();

  // At the cursor itself.
  bool ReadInteger(int32_t* value);
  bool Consume(char c) {
    if (cursor_ == line_end_ || *cursor_ != c) return false;
    ++cursor_;
    return true;
  }
  bool At(char c) const { return cursor_ < line_end_ && *cursor_ == c; }
  bool AtSpaceOrEnd() const { return cursor_ == line_end_ || IsSpace(*cursor_) || *cursor_ == '#'; }
  void SkipInteger();

 private:
  static bool IsSpace(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\\' || c == '\v' || c == '\f';
  }
  void SkipSpace() {
    while (cursor_ < line_end_ && IsSpace(*cursor_)) ++cursor_;
  }
  bool AtWordEnd() const { return cursor_ == line_end_ || *cursor_ == '#'; }
  void FindLineEnd();
  void JoinLines();

  const char* text_end_;
  const char* next_;  // first byte of the next line
  const bool has_cr_;
  const char* line_begin_ = nullptr;
  const char* line_end_ = nullptr;
  const char* cursor_ = nullptr;
  int32_t line_ = 0;
  int32_t num_continued_ = 0;
};

}  // namespace pleat
