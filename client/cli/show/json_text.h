// JSON as it is printed and written to reports.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace pleat {

// Indented, with a line break at its end. Names come from files and paths, which need not be UTF-8:
// what is not becomes U+FFFD.
std::string JsonText(const nlohmann::ordered_json& json);

}  // namespace pleat
