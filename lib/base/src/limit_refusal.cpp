#include "pleat/base/limit_refusal.h"

#include <cstdint>
#include <vector>

#include "absl/strings/cord.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace pleat {
namespace {

// The payload is "MILLISECONDS\nSUBJECT\nLIMIT", with no digits where waiting does not help.
constexpr char kPayload[] = "pleat/limit-refusal";

}  // namespace

absl::Status RefuseForLimit(const LimitRefusal& refusal, absl::string_view message) {
  absl::Status status = absl::ResourceExhaustedError(message);
  const std::string wait =
      refusal.retry_after ? absl::StrCat(absl::ToInt64Milliseconds(*refusal.retry_after)) : "";
  status.SetPayload(kPayload,
                    absl::Cord(absl::StrCat(wait, "\n", refusal.subject, "\n", refusal.limit)));
  return status;
}

std::optional<LimitRefusal> LimitRefusalOf(const absl::Status& status) {
  const auto payload = status.GetPayload(kPayload);
  if (!payload) return std::nullopt;
  const std::vector<std::string> parts =
      absl::StrSplit(std::string(*payload), absl::MaxSplits('\n', 2));
  if (parts.size() != 3) return std::nullopt;
  LimitRefusal refusal{.subject = parts[1], .limit = parts[2]};
  int64_t milliseconds = 0;
  if (absl::SimpleAtoi(parts[0], &milliseconds)) {
    refusal.retry_after = absl::Milliseconds(milliseconds);
  }
  return refusal;
}

}  // namespace pleat
