// The tokens of pages: where in a list the next page begins.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/store/catalog.h"

namespace pleat {

// Says that the next page of the entries of this kind begins behind `position`. It is good as long
// as the store, also when the entry at that position is deleted. Callers must not look into it.
std::string MakePageToken(EntryKind kind, int64_t position);

// The position of a token; 0, which is before all entries, for the empty one. kInvalidArgument for
// what MakePageToken has not made for this kind, such as the tokens of older versions.
absl::StatusOr<int64_t> ParsePageToken(EntryKind kind, const std::string& token);

}  // namespace pleat
