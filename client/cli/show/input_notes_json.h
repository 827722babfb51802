// What readers noticed, as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "pleat/mesh/input_note.h"

namespace pleat {

// A list of {severity, kind, text, frame}; frame is missing where a note is about no frame.
nlohmann::ordered_json InputNotesJson(const std::vector<InputNote>& notes);

}  // namespace pleat
