// Pictures of rigs: the mesh and its skeleton from the front and from the character's left.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/topology.h"
#include "pleat/render/render_mesh.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Returns the side of the body that each joint belongs to, by its name: "left..." or "...Left...",
// "L_hip", "hand.L", "hand_l", and the same for right. It is the middle when the name says nothing.
std::vector<BodySide> SidesOfJoints(const Skeleton& skeleton);

// One row of the sheet: some frames of one character, two pictures each.
struct RigSheetRow {
  struct View {
    std::string label;
    Eigen::Matrix3Xd positions;  // 3 x V, meters
    Eigen::Matrix3Xd joints;     // 3 x J, meters
  };
  std::string label;
  Topology topology;
  Skeleton skeleton;
  double yaw_degrees = 0;  // the facing about +y, from +z
  std::vector<View> views;
};

struct RigSheetOptions {
  int tile_width = 260, tile_height = 360;  // pixels
};

// Returns a PNG with pale meshes and their bones drawn through them (left blue, right red, middle
// dark). Every character is shown at the same height, with a front and a side view of each frame.
absl::StatusOr<std::string> RenderRigSheet(const std::vector<RigSheetRow>& rows,
                                           const RigSheetOptions& options);

}  // namespace pleat
