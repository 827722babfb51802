// Bearer tokens. The text of a token is "pleat_ID_SECRET": ID has 16 hexadecimal digits and is no
// secret, SECRET has 64 and is random. A server keeps the SHA-256 of the secret alone. A plain hash
// is enough, because nobody can guess 256 random bits.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/base/project.h"
#include "pleat/identity/scope.h"

namespace pleat {

// What a server knows about a token. Times are Unix seconds.
struct Token {
  std::string id;           // 16 lower-case hexadecimal digits
  std::string name;         // whose it is, for lists and logs; 1 to 64 bytes of UTF-8
  std::string secret_hash;  // hex SHA-256 of the 64 digits
  ScopeSet scopes;
  std::string project = kDefaultProject;  // what it sees (pleat/base/project.h)
  int64_t created = 0;
  std::optional<int64_t> expires;  // the first second at which it is no longer good; none: never
  std::optional<int64_t> revoked;  // when that happened
};

// Says whether the token is good at the time `now`.
bool IsGood(const Token& token, int64_t now);

// kInvalidArgument when the name is empty, too long, not UTF-8 or holds control characters.
absl::Status CheckTokenName(std::string_view name);

struct NewToken {
  Token token;
  std::string text;  // shown to its owner now and never again
};
// Makes a token with a random secret. `name` must pass CheckTokenName, and `project`
// CheckProjectName.
NewToken MakeToken(std::string_view name, ScopeSet scopes, int64_t now,
                   std::optional<int64_t> expires, std::string_view project = kDefaultProject);

struct TokenText {
  std::string id, secret;
};
// Takes the text of a token apart; nothing when it has another form.
std::optional<TokenText> ParseTokenText(std::string_view text);

// Says whether `secret` is that of the token. The time it takes tells nothing about the secret.
bool SecretFits(const Token& token, std::string_view secret);

}  // namespace pleat
