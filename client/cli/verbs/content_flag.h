// --content: what the frames of a server's stream hold.
#pragma once

#include <CLI/App.hpp>

#include "pleat/stream/stream_header.h"

namespace pleat {

const char* StreamContentName(StreamContent content);  // "mesh", "control", "parameters"

// The flag of `verb` that sets `content`, which outlives the parser.
void AddContentFlag(CLI::App* verb, StreamContent* content);

}  // namespace pleat
