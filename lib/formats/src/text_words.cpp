#include "text_words.h"

#include <charconv>
#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/utf8.h"

namespace pleat {

void TextWords::SkipSpace() {
  for (; cursor_ < text_.size() && IsSpace(text_[cursor_]); ++cursor_) {
    const bool is_line_end =
        text_[cursor_] == '\n' ||
        (text_[cursor_] == '\r' && (cursor_ + 1 == text_.size() || text_[cursor_ + 1] != '\n'));
    line_ += is_line_end;
  }
}

std::string_view TextWords::Next() {
  SkipSpace();
  const size_t begin = cursor_;
  while (cursor_ < text_.size() && !IsSpace(text_[cursor_])) {
    const bool is_brace = text_[cursor_] == '{' || text_[cursor_] == '}';
    if (is_brace && cursor_ > begin) break;
    ++cursor_;
    if (is_brace) break;
  }
  return text_.substr(begin, cursor_ - begin);
}

std::string_view TextWords::RestOfName() {
  const size_t begin = cursor_;
  while (cursor_ < text_.size() && text_[cursor_] != '\n' && text_[cursor_] != '\r' &&
         text_[cursor_] != '{') {
    ++cursor_;
  }
  const absl::string_view name =
      absl::StripAsciiWhitespace(absl::string_view(text_.data() + begin, cursor_ - begin));
  return {name.data(), name.size()};
}

std::string_view TextWords::NextLine() {
  SkipSpace();
  const size_t begin = cursor_;
  while (cursor_ < text_.size() && text_[cursor_] != '\n' && text_[cursor_] != '\r') ++cursor_;
  const absl::string_view line =
      absl::StripTrailingAsciiWhitespace(absl::string_view(text_.data() + begin, cursor_ - begin));
  return {line.data(), line.size()};
}

bool ParseNumber(std::string_view word, double* value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const std::from_chars_result result =
      std::from_chars(word.data(), word.data() + word.size(), *value);
  return result.ec == std::errc() && result.ptr == word.data() + word.size() &&
         std::isfinite(*value);
}

std::string QuotedWord(std::string_view word) {
  constexpr size_t kMaxShown = 40;
  return absl::StrCat("'", EscapeControls(word.substr(0, kMaxShown)),
                      word.size() > kMaxShown ? "..." : "", "'");
}

}  // namespace pleat
