// Text for proto3 strings, which must be UTF-8: a reader refuses the whole message otherwise.
#pragma once

#include <string>
#include <string_view>

namespace pleat {

// `text` with every byte that is not part of a valid UTF-8 sequence replaced by U+FFFD.
std::string ToValidUtf8(std::string_view text);

}  // namespace pleat
