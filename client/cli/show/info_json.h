// What the service says about its objects, as JSON for machines.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "pleat/service/character_service.h"

namespace pleat {

nlohmann::ordered_json SequenceJson(const SequenceInfo& info);
// Returns "training" or "compression".
const char* JobKindName(const JobInfo& info);
nlohmann::ordered_json JobJson(const JobInfo& info);
nlohmann::ordered_json ModelJson(const ModelInfo& info);
nlohmann::ordered_json CompressedSequenceJson(const CompressedSequenceInfo& info);

}  // namespace pleat
