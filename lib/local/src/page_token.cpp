#include "page_token.h"

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace pleat {
namespace {

// The tokens of 0.1.0 were the ids of items, without a version.
std::string Prefix(EntryKind kind) { return absl::StrCat("2:", EntryKindName(kind), ":"); }

}  // namespace

std::string MakePageToken(EntryKind kind, int64_t position) {
  return absl::WebSafeBase64Escape(absl::StrCat(Prefix(kind), position));
}

absl::StatusOr<int64_t> ParsePageToken(EntryKind kind, const std::string& token) {
  if (token.empty()) return 0;
  std::string text;
  int64_t position = 0;
  const bool is_text = absl::WebSafeBase64Unescape(token, &text);
  absl::string_view digits = text;
  const bool is_good = is_text && absl::ConsumePrefix(&digits, Prefix(kind)) &&
                       absl::SimpleAtoi(digits, &position) && position > 0;
  // Only what would be made again: one position has one token.
  if (is_good && MakePageToken(kind, position) == token) return position;
  return absl::InvalidArgumentError(
      absl::StrCat("page_token was not given by this list of ", EntryKindName(kind),
                   "s (or by an older version of the server); start again without a token"));
}

}  // namespace pleat
