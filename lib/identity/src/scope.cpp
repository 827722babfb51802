#include "pleat/identity/scope.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"

namespace pleat {

const char* ScopeName(Scope scope) {
  switch (scope) {
    case Scope::kRead:
      return "read";
    case Scope::kPose:
      return "pose";
    case Scope::kTrain:
      return "train";
    case Scope::kAdmin:
      return "admin";
  }
  return "unknown";
}

std::string ScopesText(ScopeSet scopes) {
  std::vector<const char*> names;
  for (const Scope scope : kScopes) {
    if (scopes.Has(scope)) names.push_back(ScopeName(scope));
  }
  return absl::StrJoin(names, ",");
}

absl::StatusOr<ScopeSet> ParseScopes(std::string_view text) {
  ScopeSet scopes;
  for (const absl::string_view name :
       absl::StrSplit(absl::string_view(text.data(), text.size()), ',')) {
    bool known = false;
    for (const Scope scope : kScopes) {
      if (name != ScopeName(scope)) continue;
      scopes.Add(scope);
      known = true;
    }
    if (!known) {
      return absl::InvalidArgumentError(absl::StrCat(
          "there is no scope '", name, "'; the scopes are read, pose, train and admin"));
    }
  }
  return scopes;
}

}  // namespace pleat
