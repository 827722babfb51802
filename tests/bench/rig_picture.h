// Pictures of rigs, since left and right are seen faster than measured.
#pragma once

#include <Eigen/Core>
#include <string>

#include "pleat/rigging/auto_rig.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// Writes <folder>/<name>.png: the rest mesh with its skeleton, from the front and from its left
// side. triangles: 3 x F.
void DrawRig(const std::string& name, const Eigen::Matrix3Xi& triangles, const Rig& rig,
             const AutoRigSummary& summary, const std::string& folder);

}  // namespace pleat
