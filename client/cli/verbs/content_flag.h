// The flag --content: what the frames of a server's stream hold.
#pragma once

#include <CLI/App.hpp>

#include "pleat/stream/stream_header.h"

namespace pleat {

const char* StreamContentName(StreamContent content);  // "mesh", "control", "parameters"

// Adds the flag to `verb`. It sets `content`, which must outlive the parser.
void AddContentFlag(CLI::App* verb, StreamContent* content);

}  // namespace pleat
