// Stored files describe themselves.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/store/store_repair.h"

namespace pleat {

// Says whether the bytes are a sequence, a model or a compressed sequence, and makes the record of
// its row. kInvalidArgument when they are none of them. Rigs are not recognized: they belong to
// jobs, which are lost when their rows are.
absl::StatusOr<FileDescription> DescribeStoredFile(const std::string& id, const std::string& bytes);

}  // namespace pleat
