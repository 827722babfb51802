#include "pleat/base/project.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

constexpr size_t kMaxNameBytes = 48;

bool IsAlphanumeric(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }

}  // namespace

absl::Status CheckProjectName(std::string_view name) {
  const bool is_good =
      !name.empty() && name.size() <= kMaxNameBytes && IsAlphanumeric(name[0]) &&
      std::ranges::all_of(name, [](char c) { return IsAlphanumeric(c) || c == '-' || c == '_'; });
  if (is_good) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("the name of a project has 1 to ", kMaxNameBytes,
                   " characters, all of them a-z, 0-9, '-' or '_', and begins with a letter or a "
                   "digit"));
}

}  // namespace pleat
