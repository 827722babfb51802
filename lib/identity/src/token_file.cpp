// The format: docs/formats/token_file.md.
#include "pleat/identity/token_file.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/file_lock.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr uint64_t kMaxFileBytes = 16 << 20;

absl::Status Malformed(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("the token file is malformed: ", what));
}

std::string StringIn(const ordered_json& object, const char* field) {
  const auto it = object.find(field);
  return it != object.end() && it->is_string() ? it->get<std::string>() : "";
}

// Absent and null mean that there is no such time.
absl::Status ReadTime(const ordered_json& object, const char* field, std::optional<int64_t>* time) {
  const auto it = object.find(field);
  if (it == object.end() || it->is_null()) return absl::OkStatus();
  if (!it->is_number_integer()) return Malformed(absl::StrCat("'", field, "' is no Unix time"));
  *time = it->get<int64_t>();
  return absl::OkStatus();
}

absl::StatusOr<Token> ReadToken(const ordered_json& object) {
  if (!object.is_object()) return Malformed("a token is a JSON object");
  Token token;
  token.id = StringIn(object, "id");
  token.name = StringIn(object, "name");
  token.secret_hash = StringIn(object, "secret_sha256");
  // The hash has as many digits as a secret, so this checks the form of both.
  if (!ParseTokenText(absl::StrCat("pleat_", token.id, "_", token.secret_hash))) {
    return Malformed("a token has an 'id' of 16 and a 'secret_sha256' of 64 hexadecimal digits");
  }
  const std::string where = absl::StrCat("token ", token.id);
  PLEAT_RETURN_IF_ERROR(WithContext(where, CheckTokenName(token.name)));
  PLEAT_ASSIGN_OR_RETURN(token.scopes, WithContext(where, ParseScopes(StringIn(object, "scopes"))));
  if (object.contains("project")) {  // older files know none
    token.project = StringIn(object, "project");
    PLEAT_RETURN_IF_ERROR(WithContext(where, CheckProjectName(token.project)));
  }
  std::optional<int64_t> created;
  PLEAT_RETURN_IF_ERROR(WithContext(where, ReadTime(object, "created", &created)));
  PLEAT_RETURN_IF_ERROR(WithContext(where, ReadTime(object, "expires", &token.expires)));
  PLEAT_RETURN_IF_ERROR(WithContext(where, ReadTime(object, "revoked", &token.revoked)));
  token.created = created.value_or(0);
  return token;
}

}  // namespace

absl::StatusOr<std::vector<Token>> ParseTokens(std::string_view json) {
  const ordered_json root = ordered_json::parse(json, nullptr, /*allow_exceptions=*/false);
  if (!root.is_object()) return Malformed("it is no JSON object");
  const auto version = root.find("version");
  if (version == root.end() || !version->is_number_integer() || *version != kVersion) {
    return Malformed(absl::StrCat("its version is not ", kVersion));
  }
  const auto list = root.find("tokens");
  if (list == root.end() || !list->is_array()) return Malformed("it has no list 'tokens'");
  std::vector<Token> tokens;
  for (const ordered_json& object : *list) {
    PLEAT_ASSIGN_OR_RETURN(Token token, ReadToken(object));
    tokens.push_back(std::move(token));
  }
  return tokens;
}

std::string FormatTokens(const std::vector<Token>& tokens) {
  ordered_json list = ordered_json::array();
  for (const Token& token : tokens) {
    ordered_json object{{"id", token.id},
                        {"name", token.name},
                        {"scopes", ScopesText(token.scopes)},
                        {"secret_sha256", token.secret_hash},
                        {"created", token.created}};
    if (token.project != kDefaultProject) object["project"] = token.project;
    if (token.expires) object["expires"] = *token.expires;
    if (token.revoked) object["revoked"] = *token.revoked;
    list.push_back(std::move(object));
  }
  return ordered_json{{"version", kVersion}, {"tokens", std::move(list)}}.dump(2) + "\n";
}

std::string TokenPath(const std::string& data_dir) { return data_dir + "/tokens.json"; }

absl::StatusOr<std::vector<Token>> ReadTokens(const std::string& path) {
  const absl::StatusOr<std::string> bytes = ReadFile(path, kMaxFileBytes);
  if (absl::IsNotFound(bytes.status())) return std::vector<Token>{};
  PLEAT_RETURN_IF_ERROR(bytes.status());
  return WithContext(absl::StrCat("'", path, "'"), ParseTokens(*bytes));
}

absl::Status ChangeTokens(const std::string& path,
                          absl::FunctionRef<absl::Status(std::vector<Token>*)> change) {
  // On a file beside the tokens, because the file of the tokens itself is replaced.
  PLEAT_ASSIGN_OR_RETURN(const FileLock lock, FileLock::Wait(path + ".lock", 0600));
  PLEAT_ASSIGN_OR_RETURN(std::vector<Token> tokens, ReadTokens(path));
  PLEAT_RETURN_IF_ERROR(change(&tokens));
  return WriteFile(path, FormatTokens(tokens), 0600);
}

}  // namespace pleat
