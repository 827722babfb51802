// Ids that nobody else has.
#pragma once

#include <string>

namespace pleat {

// Returns 8 * num_words random lower-case hexadecimal digits, from the system. No result of a
// computation may depend on them.
std::string RandomHexId(int num_words);

}  // namespace pleat
