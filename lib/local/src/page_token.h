// Tokens of pages: where the next page of a list begins.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/store/catalog.h"

namespace pleat {

// The lists of one project. A position counts the entries of all projects, so a token that could be
// read would tell how much others store. It is encrypted and authenticated with a key that only the
// catalog knows: a token says nothing, and none can be made up or used in another list.
class PageTokens {
 public:
  PageTokens(std::string secret, std::string project)
      : secret_(std::move(secret)), project_(std::move(project)) {}

  // One position has one token.
  std::string Make(EntryKind kind, int64_t position) const;
  // 0 for the empty token, which is that of the first page. kInvalidArgument for a token that this
  // list did not give.
  absl::StatusOr<int64_t> Parse(EntryKind kind, const std::string& token) const;

 private:
  // Eight bytes that depend on everything that a token stands for.
  std::string TagOf(EntryKind kind, int64_t position) const;
  // Eight bytes that hide the position.
  uint64_t MaskOf(const std::string& tag) const;

  const std::string secret_, project_;
};

}  // namespace pleat
