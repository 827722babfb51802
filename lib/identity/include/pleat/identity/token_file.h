// The tokens of one server as a file, which `pleat token` changes and pleatd reads.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/identity/token.h"

namespace pleat {

// The format is docs/formats/token_file.md. kInvalidArgument says which token is wrong.
absl::StatusOr<std::vector<Token>> ParseTokens(std::string_view json);
std::string FormatTokens(const std::vector<Token>& tokens);

// Where the tokens of a data folder are.
std::string TokenPath(const std::string& data_dir);

// Returns no tokens when the file does not exist.
absl::StatusOr<std::vector<Token>> ReadTokens(const std::string& path);

// Reads the file, lets `change` change the tokens, and replaces the file, which only its owner can
// read. Two processes that do this at the same time take turns. An error of `change` leaves the
// file as it is and is returned.
absl::Status ChangeTokens(const std::string& path,
                          absl::FunctionRef<absl::Status(std::vector<Token>*)> change);

}  // namespace pleat
