#include "obj_lines.h"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

const char* Find(char c, const char* begin, const char* end) {
  const auto* found =
      static_cast<const char*>(std::memchr(begin, c, static_cast<size_t>(end - begin)));
  return found ? found : end;
}

}  // namespace

ObjLines::ObjLines(std::string_view text)
    : text_end_(text.data() + text.size()),
      next_(text.data() + (text.starts_with("\xef\xbb\xbf") ? 3 : 0)),
      has_cr_(Find('\r', next_, text_end_) != text_end_) {}

void ObjLines::FindLineEnd() {
  line_end_ = Find('\n', next_, text_end_);
  if (has_cr_) line_end_ = Find('\r', next_, line_end_);
  next_ = line_end_;
  if (next_ < text_end_) ++next_;
  if (next_ < text_end_ && *line_end_ == '\r' && *next_ == '\n') ++next_;
}

bool ObjLines::Next() {
  if (next_ == text_end_) return false;
  line_ += 1 + num_continued_;
  num_continued_ = 0;
  line_begin_ = cursor_ = next_;
  FindLineEnd();
  return true;
}

void ObjLines::JoinLines() {
  const char* begin = cursor_;  // of the last joined line
  while (line_end_ > begin && line_end_[-1] == '\\' && next_ < text_end_ &&
         Find('#', begin, line_end_) == line_end_) {
    begin = next_;
    ++num_continued_;
    FindLineEnd();
  }
}

std::string_view ObjLines::Word() {
  SkipSpace();
  const char* begin = cursor_;
  while (cursor_ < line_end_ && !IsSpace(*cursor_)) ++cursor_;
  return {begin, static_cast<size_t>(cursor_ - begin)};
}

std::string_view ObjLines::RestOfLine() {
  while (cursor_ < line_end_ && (*cursor_ == ' ' || *cursor_ == '\t')) ++cursor_;
  const char* end = line_end_;
  while (end > cursor_ && end[-1] != '\\' && IsSpace(end[-1])) --end;
  return {cursor_, static_cast<size_t>(end - cursor_)};
}

std::string ObjLines::Found() {
  SkipSpace();
  const char* end = cursor_;
  while (end < line_end_ && !IsSpace(*end) && end - cursor_ < 32) ++end;
  if (end == cursor_) return "the end of the line";
  const std::string_view word(cursor_, static_cast<size_t>(end - cursor_));
  return absl::StrCat("'", EscapeControls(word), "'");
}

bool ObjLines::ReadFloat(float* value) {
  SkipSpace();
  const char* begin = At('+') ? cursor_ + 1 : cursor_;
  const std::from_chars_result result = std::from_chars(begin, line_end_, *value);
  if (result.ec == std::errc::result_out_of_range) {
    // Too small for float32 (a negative exponent) is zero, too large is an error.
    if (result.ptr - begin < 2 || std::find(begin + 1, result.ptr, '-') == result.ptr) return false;
    *value = 0;
  } else if (result.ec != std::errc()) {
    return false;
  }
  if (result.ptr < line_end_ && !IsSpace(*result.ptr) && *result.ptr != '#') return false;
  cursor_ = result.ptr;
  return true;
}

bool ObjLines::ReadInteger(int32_t* value) {
  const std::from_chars_result result = std::from_chars(cursor_, line_end_, *value);
  if (result.ec != std::errc()) return false;
  cursor_ = result.ptr;
  return true;
}

void ObjLines::SkipInteger() {
  if (At('-') || At('+')) ++cursor_;
  while (cursor_ < line_end_ && *cursor_ >= '0' && *cursor_ <= '9') ++cursor_;
}

}  // namespace pleat
