// Which record a row of each kind holds.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "pleat/store/catalog.h"

namespace pleat {

// OK when `record` can be decoded as what a row of this kind holds; rigs have none.
absl::Status CheckRecord(EntryKind kind, const std::string& record);

}  // namespace pleat
