// The tables of the catalog, and how those of older versions become them.
#pragma once

#include <string>

namespace pleat {

inline constexpr int kCatalogVersion = 5;

// The statements that bring a catalog of `version`, 0 for an empty file, to kCatalogVersion, as one
// transaction.
std::string SchemaUpgrade(int version);

}  // namespace pleat
