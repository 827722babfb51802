#include "cli/show/input_notes_json.h"

#include <nlohmann/json.hpp>

#include "pleat/base/utf8.h"

namespace pleat {

nlohmann::ordered_json InputNotesJson(const std::vector<InputNote>& notes) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const InputNote& note : notes) {
    nlohmann::ordered_json json;
    json["severity"] = SeverityName(note.severity);
    json["kind"] = note.kind;
    json["text"] = ToValidUtf8(note.text);
    if (note.frame) json["frame"] = *note.frame;
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace pleat
