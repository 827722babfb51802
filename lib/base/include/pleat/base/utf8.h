// Text from outside: for proto3 strings, which must be UTF-8 (a reader refuses the whole message
// otherwise), and for messages that a terminal shows.
#pragma once

#include <string>
#include <string_view>

namespace pleat {

bool IsValidUtf8(std::string_view text);

// `text` with every byte that is not part of a valid UTF-8 sequence replaced by U+FFFD.
std::string ToValidUtf8(std::string_view text);

// A name that a file holds, as UTF-8. Text that is no UTF-8 is taken as Latin-1, the encoding of
// most older exporters; the C1 control codes, which no name holds, become U+FFFD. Thus different
// names stay different.
std::string NameToUtf8(std::string_view name);

// The longest prefix of `text` with at most `max_bytes` bytes that cuts no sequence in two.
std::string_view Utf8Prefix(std::string_view text, size_t max_bytes);

// `text` for a message: control characters and bytes that are not UTF-8 become \xNN, so that a
// file cannot move the cursor or color the terminal. Line breaks and tabs are escaped as well
// unless `keep_lines`.
std::string EscapeControls(std::string_view text, bool keep_lines = false);

}  // namespace pleat
