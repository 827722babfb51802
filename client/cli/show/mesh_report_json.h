// The pre-flight report of a mesh as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "pleat/mesh/mesh_report.h"

namespace pleat {

nlohmann::ordered_json MeshReportJson(const MeshReport& report);

}  // namespace pleat
