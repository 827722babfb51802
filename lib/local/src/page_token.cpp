#include "page_token.h"

#include <cstring>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/sha256.h"

namespace pleat {
namespace {

constexpr size_t kWordBytes = sizeof(uint64_t);

std::string FirstWordOf(const std::string& text) {
  const auto digest = ComputeSha256(text);
  return std::string(reinterpret_cast<const char*>(digest.data()), kWordBytes);
}

}  // namespace

// Keyed by a secret in front, and cut to eight bytes, so that a hash cannot be continued.
std::string PageTokens::TagOf(EntryKind kind, int64_t position) const {
  return FirstWordOf(
      absl::StrCat(secret_, "|tag|", project_, "|", EntryKindName(kind), "|", position));
}

uint64_t PageTokens::MaskOf(const std::string& tag) const {
  const std::string bytes = FirstWordOf(absl::StrCat(secret_, "|mask|", tag));
  uint64_t mask = 0;
  std::memcpy(&mask, bytes.data(), kWordBytes);
  return mask;
}

std::string PageTokens::Make(EntryKind kind, int64_t position) const {
  const std::string tag = TagOf(kind, position);
  const uint64_t hidden = static_cast<uint64_t>(position) ^ MaskOf(tag);
  std::string bytes = tag;
  bytes.append(reinterpret_cast<const char*>(&hidden), kWordBytes);
  return absl::WebSafeBase64Escape(bytes);
}

absl::StatusOr<int64_t> PageTokens::Parse(EntryKind kind, const std::string& token) const {
  if (token.empty()) return 0;
  std::string bytes;
  if (absl::WebSafeBase64Unescape(token, &bytes) && bytes.size() == 2 * kWordBytes) {
    const std::string tag = bytes.substr(0, kWordBytes);
    uint64_t hidden = 0;
    std::memcpy(&hidden, bytes.data() + kWordBytes, kWordBytes);
    const auto position = static_cast<int64_t>(hidden ^ MaskOf(tag));
    // Only what would be made again.
    if (position > 0 && Make(kind, position) == token) return position;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("page_token was not given by this list of ", EntryKindName(kind),
                   "s (or by an older version of the server); start again without a token"));
}

}  // namespace pleat
