// The names of joints in a message.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/strings/str_join.h"
#include "pleat/base/utf8.h"

namespace pleat {

// Returns at most `max_names` names without control bytes, separated by commas; tips are left out.
// Joint: has `name` and `is_end`.
template <typename Joint>
std::string ListJointNames(const std::vector<Joint>& joints, size_t max_names) {
  std::vector<std::string> names;
  for (const Joint& joint : joints) {
    if (joint.is_end) continue;
    if (names.size() == max_names) {
      names.emplace_back("...");
      break;
    }
    names.push_back(EscapeControls(joint.name));
  }
  return absl::StrJoin(names, ", ");
}

}  // namespace pleat
