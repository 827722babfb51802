// How deep JSON from outside may nest.
#pragma once

#include <string_view>

namespace pleat {

// Says whether the brackets of a text nest deeper than `max_depth`. Every level costs the parser
// memory, and the copies of what it returns stack, so this is found out before it runs.
bool NestsTooDeep(std::string_view text, int max_depth);

}  // namespace pleat
