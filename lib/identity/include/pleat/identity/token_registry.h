// The tokens of a running server, always as its token file has them at the moment.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/identity/token.h"

namespace pleat {

struct TokenRegistryOptions {
  std::string path{};                // of the token file, which may not exist yet
  std::function<int64_t()> clock{};  // Unix seconds
  // Receives one sentence for the operator when the file cannot be read any more.
  std::function<void(const std::string& problem)> on_problem{};
};

// Each question looks whether the file has changed, which takes a microsecond, so a token that is
// revoked is refused from the next question on. A file that cannot be read any more leaves the
// tokens as they were. Thread-safe.
class TokenRegistry {
 public:
  // The error of a file that exists and cannot be read.
  static absl::StatusOr<std::unique_ptr<TokenRegistry>> Open(TokenRegistryOptions options);

  // Says whether calls need a token: true as soon as the file has held one, and from then on, so
  // that a file that vanishes opens no door.
  bool required();

  // Gives the token whose text this is. kUnauthenticated when there is none, or when it has expired
  // or was revoked.
  absl::StatusOr<Token> Authenticate(std::string_view text);

  // The name of the token `id`, good or not; empty when there is none.
  std::string NameOf(const std::string& id);

  // Says whether calls that began with the token `id` may go on.
  bool IsStillGood(const std::string& id);

 private:
  // What tells one version of a file from another.
  struct FileState {
    uint64_t inode = 0;
    int64_t modified_ns = 0, size_bytes = -1;  // -1: there is no file
    friend bool operator==(const FileState&, const FileState&) = default;
  };

  explicit TokenRegistry(TokenRegistryOptions options) : options_(std::move(options)) {}
  absl::Status Refresh();  // with mutex_ held
  void RefreshOrReport();  // with mutex_ held
  static FileState StateOf(const std::string& path);

  const TokenRegistryOptions options_;
  std::mutex mutex_;  // guards all below
  FileState state_;
  std::map<std::string, Token> tokens_;  // by id
  bool required_ = false;
};

}  // namespace pleat
