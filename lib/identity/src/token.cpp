#include "pleat/identity/token.h"

#include <openssl/crypto.h>

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/random_id.h"
#include "pleat/base/sha256.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr std::string_view kPrefix = "pleat_";
constexpr int kIdWords = 2, kSecretWords = 8;  // of 8 hexadecimal digits
constexpr size_t kIdDigits = 8 * kIdWords, kSecretDigits = 8 * kSecretWords;
constexpr size_t kMaxNameBytes = 64;

bool IsHex(std::string_view text) {
  return std::ranges::all_of(
      text, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

std::string HashOf(std::string_view secret) { return ToHex(ComputeSha256(secret)); }

}  // namespace

bool IsGood(const Token& token, int64_t now) {
  return !token.revoked && (!token.expires || now < *token.expires);
}

absl::Status CheckTokenName(std::string_view name) {
  if (name.empty() || name.size() > kMaxNameBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("the name of a token has 1 to ", kMaxNameBytes, " bytes"));
  }
  if (EscapeControls(name) != name) {
    return absl::InvalidArgumentError(
        "the name of a token must be UTF-8 text without control characters");
  }
  return absl::OkStatus();
}

NewToken MakeToken(std::string_view name, ScopeSet scopes, int64_t now,
                   std::optional<int64_t> expires, std::string_view project) {
  const std::string secret = RandomHexId(kSecretWords);
  Token token{.id = RandomHexId(kIdWords),
              .name = std::string(name),
              .secret_hash = HashOf(secret),
              .scopes = scopes,
              .project = std::string(project),
              .created = now,
              .expires = expires,
              .revoked = {}};
  std::string text = absl::StrCat("pleat_", token.id, "_", secret);
  return {std::move(token), std::move(text)};
}

std::optional<TokenText> ParseTokenText(std::string_view text) {
  if (text.size() != kPrefix.size() + kIdDigits + 1 + kSecretDigits ||
      text.substr(0, kPrefix.size()) != kPrefix) {
    return std::nullopt;
  }
  text.remove_prefix(kPrefix.size());
  const std::string_view id = text.substr(0, kIdDigits), secret = text.substr(kIdDigits + 1);
  if (text[kIdDigits] != '_' || !IsHex(id) || !IsHex(secret)) return std::nullopt;
  return TokenText{std::string(id), std::string(secret)};
}

bool SecretFits(const Token& token, std::string_view secret) {
  const std::string hash = HashOf(secret);
  return hash.size() == token.secret_hash.size() &&
         CRYPTO_memcmp(hash.data(), token.secret_hash.data(), hash.size()) == 0;
}

}  // namespace pleat
