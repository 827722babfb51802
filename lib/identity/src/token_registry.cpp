#include "pleat/identity/token_registry.h"

#include <sys/stat.h>

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/identity/token_file.h"

namespace pleat {

absl::StatusOr<std::unique_ptr<TokenRegistry>> TokenRegistry::Open(TokenRegistryOptions options) {
  std::unique_ptr<TokenRegistry> registry(new TokenRegistry(std::move(options)));
  std::lock_guard lock(registry->mutex_);
  PLEAT_RETURN_IF_ERROR(registry->Refresh());
  return registry;
}

TokenRegistry::FileState TokenRegistry::StateOf(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return {};
  return {.inode = info.st_ino,
          .modified_ns = info.st_mtim.tv_sec * int64_t{1'000'000'000} + info.st_mtim.tv_nsec,
          .size_bytes = info.st_size};
}

absl::Status TokenRegistry::Refresh() {
  // The state is taken before the content: a change in between is seen the next time.
  const FileState state = StateOf(options_.path);
  if (state == state_) return absl::OkStatus();
  state_ = state;
  PLEAT_ASSIGN_OR_RETURN(std::vector<Token> tokens, ReadTokens(options_.path));
  tokens_.clear();
  for (Token& token : tokens) {
    std::string id = token.id;
    tokens_.insert_or_assign(std::move(id), std::move(token));
  }
  required_ = required_ || !tokens_.empty();
  return absl::OkStatus();
}

void TokenRegistry::RefreshOrReport() {
  const absl::Status status = Refresh();
  if (!status.ok() && options_.on_problem) {
    options_.on_problem(
        absl::StrCat("the tokens stay as they were before, since ", status.message()));
  }
}

bool TokenRegistry::required() {
  std::lock_guard lock(mutex_);
  RefreshOrReport();
  return required_;
}

absl::StatusOr<Token> TokenRegistry::Authenticate(std::string_view text) {
  const std::optional<TokenText> parts = ParseTokenText(text);
  if (!parts) {
    return absl::UnauthenticatedError(
        "this server asks for a token of the form pleat_ID_SECRET; its operator makes one with "
        "'pleat token create'");
  }
  std::lock_guard lock(mutex_);
  RefreshOrReport();
  const auto it = tokens_.find(parts->id);
  if (it == tokens_.end() || !SecretFits(it->second, parts->secret)) {
    return absl::UnauthenticatedError("the server does not know this token");
  }
  if (!IsGood(it->second, options_.clock())) {
    return absl::UnauthenticatedError(absl::StrCat(
        "the token '", it->second.name, "' ", it->second.revoked ? "was revoked" : "has expired",
        "; ask the operator for a new one"));
  }
  return it->second;
}

std::string TokenRegistry::NameOf(const std::string& id) {
  std::lock_guard lock(mutex_);
  RefreshOrReport();
  const auto it = tokens_.find(id);
  return it == tokens_.end() ? "" : it->second.name;
}

bool TokenRegistry::IsStillGood(const std::string& id) {
  std::lock_guard lock(mutex_);
  RefreshOrReport();
  const auto it = tokens_.find(id);
  return it != tokens_.end() && IsGood(it->second, options_.clock());
}

}  // namespace pleat
