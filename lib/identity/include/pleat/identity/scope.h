// What the owner of a token may do.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace pleat {

// kRead: see and download what is stored. kPose: ask models for frames and decode compressed
// sequences. kTrain: upload, create jobs and cancel them. kAdmin: delete, pin.
enum class Scope : uint8_t { kRead, kPose, kTrain, kAdmin };
inline constexpr Scope kScopes[] = {Scope::kRead, Scope::kPose, Scope::kTrain, Scope::kAdmin};
const char* ScopeName(Scope scope);  // "read", "pose", "train", "admin"

class ScopeSet {
 public:
  constexpr ScopeSet() = default;
  static constexpr ScopeSet All() {
    ScopeSet all;
    for (const Scope scope : kScopes) all.Add(scope);
    return all;
  }

  constexpr void Add(Scope scope) { bits_ |= Bit(scope); }
  constexpr bool Has(Scope scope) const { return (bits_ & Bit(scope)) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  friend constexpr bool operator==(ScopeSet, ScopeSet) = default;

 private:
  static constexpr uint8_t Bit(Scope scope) {
    return static_cast<uint8_t>(1u << static_cast<unsigned>(scope));
  }
  uint8_t bits_ = 0;
};

// "read,pose", in the order of kScopes.
std::string ScopesText(ScopeSet scopes);
// Reads such a text, in any order. kInvalidArgument for an unknown name and for an empty text.
absl::StatusOr<ScopeSet> ParseScopes(std::string_view text);

}  // namespace pleat
