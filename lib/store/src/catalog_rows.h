// What all questions to the catalog share.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "database.h"
#include "pleat/store/catalog.h"

namespace pleat {

// The rows of a statement of Catalog::Select.
absl::StatusOr<std::vector<CatalogEntry>> ReadEntries(Statement* statement);

// kNotFound, in the words that every question about one entry has.
absl::Status NotThere(EntryKind kind, const std::string& id);

}  // namespace pleat
