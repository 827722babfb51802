// Token files for tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pleat/identity/token_file.h"
#include "pleat/identity/token_registry.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {

// A folder with a token file, and a registry that reads it.
class TestTokens {
 public:
  static constexpr int64_t kNow = 1000;  // seconds of the registry's clock

  TokenRegistry* registry() { return registry_.get(); }
  const std::string& folder() const { return folder_.path(); }
  const std::string& path() const { return path_; }

  NewToken Add(const std::string& name, const std::string& scopes,
               const std::string& project = kDefaultProject) {
    NewToken made = MakeToken(name, ParseScopes(scopes).value(), kNow, {}, project);
    EXPECT_THAT(ChangeTokens(path_,
                             [&](std::vector<Token>* tokens) {
                               tokens->push_back(made.token);
                               return absl::OkStatus();
                             }),
                IsOk());
    return made;
  }
  void Revoke(const std::string& id) {
    EXPECT_THAT(ChangeTokens(path_,
                             [&](std::vector<Token>* tokens) {
                               for (Token& token : *tokens) {
                                 if (token.id == id) token.revoked = kNow;
                               }
                               return absl::OkStatus();
                             }),
                IsOk());
  }

 private:
  TemporaryFolder folder_;
  const std::string path_ = TokenPath(folder_.path());
  std::unique_ptr<TokenRegistry> registry_ =
      TokenRegistry::Open({.path = path_, .clock = [] { return kNow; }}).value();
};

}  // namespace pleat
