// Lays the mesh of a rig file on a clip when the two differ by a rigid motion or a unit.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "pleat/formats/rig_file.h"
#include "pleat/mesh/input_note.h"

namespace pleat {

// Moves positions and joints of `file`, which has positions, so that every point of `rest` (3 x V,
// meters) lies within max_distance_m of one of them. A file that does already stays as it is; any
// other motion is said in `notes`, which may be null. When nothing fits, the file stays as it is as
// well. kInvalidArgument when it fits in several ways that are equally good.
absl::Status AlignRig(const Eigen::Matrix3Xd& rest, double max_distance_m, RigFile* file,
                      std::vector<InputNote>* notes);

}  // namespace pleat
