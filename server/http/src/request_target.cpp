#include "request_target.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr size_t kMaxTargetBytes = 8 << 10;
constexpr size_t kMaxParts = 32;
constexpr size_t kMaxNameBytes = 200;
constexpr size_t kMaxFolders = 8;

bool HasControls(std::string_view text) {
  for (const char c : text) {
    if (absl::ascii_iscntrl(static_cast<unsigned char>(c))) return true;
  }
  return false;
}

// At most so many parts and one more, so that a caller sees that there are too many.
std::vector<std::string_view> Split(std::string_view text, char separator, size_t max_parts) {
  std::vector<std::string_view> parts;
  while (parts.size() <= max_parts) {
    const size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return parts;
}

int HexValue(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char lower = absl::ascii_tolower(static_cast<unsigned char>(c));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

absl::StatusOr<std::string> Decode(std::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded.push_back(text[i]);
      continue;
    }
    const int high = i + 2 < text.size() ? HexValue(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? HexValue(text[i + 2]) : -1;
    if (high < 0 || low < 0) {
      return absl::InvalidArgumentError("a '%' of the address is not followed by two digits");
    }
    decoded.push_back(static_cast<char>(16 * high + low));
    i += 2;
  }
  if (HasControls(decoded) || !IsValidUtf8(decoded)) {
    return absl::InvalidArgumentError("the address holds bytes that are no text");
  }
  return decoded;
}

}  // namespace

absl::StatusOr<RequestTarget> ParseTarget(std::string_view target) {
  if (target.size() > kMaxTargetBytes || target.empty() || target[0] != '/') {
    return absl::InvalidArgumentError("the address is no path, or longer than 8 kB");
  }
  RequestTarget parsed;
  const size_t mark = target.find('?');
  const std::string_view path = target.substr(1, mark == std::string_view::npos ? mark : mark - 1);
  for (const std::string_view part : Split(path, '/', kMaxParts)) {
    if (parsed.segments.size() == kMaxParts) {
      return absl::InvalidArgumentError("the address has too many parts");
    }
    PLEAT_ASSIGN_OR_RETURN(std::string segment, Decode(part));
    parsed.segments.push_back(std::move(segment));
  }
  if (mark == std::string_view::npos) return parsed;
  for (const std::string_view part : Split(target.substr(mark + 1), '&', kMaxParts + 1)) {
    if (part.empty()) continue;
    if (parsed.query.size() == kMaxParts) {
      return absl::InvalidArgumentError("the address has too many values");
    }
    const size_t equal = part.find('=');
    PLEAT_ASSIGN_OR_RETURN(std::string name, Decode(part.substr(0, equal)));
    PLEAT_ASSIGN_OR_RETURN(
        std::string value,
        Decode(equal == std::string_view::npos ? std::string_view() : part.substr(equal + 1)));
    parsed.query[std::move(name)] = std::move(value);
  }
  return parsed;
}

absl::StatusOr<std::string> CheckRelativePath(std::string_view path) {
  const std::vector<std::string_view> parts = Split(path, '/', kMaxFolders);
  if (parts.size() > kMaxFolders) {
    return absl::InvalidArgumentError("a file lies in more than 8 folders");
  }
  if (HasControls(path) || !IsValidUtf8(path) || path.find('\\') != std::string_view::npos) {
    return absl::InvalidArgumentError("the name of a file holds bytes that no name may have");
  }
  for (const std::string_view part : parts) {
    // Hidden files are none of a take's, and the names of the parent and of the folder itself
    // begin with a dot as well.
    if (part.empty() || part[0] == '.' || part.size() > kMaxNameBytes) {
      return absl::InvalidArgumentError(
          absl::StrCat("'", EscapeControls(path), "' is no name of a file inside a folder"));
    }
  }
  return std::string(path);
}

}  // namespace pleat
