// Skins of a glTF file and the influences of vertices, as the file lists them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "glb_container.h"
#include "glb_nodes.h"
#include "pleat/skinning/user_rig.h"

namespace pleat {

struct GlbSkin {
  std::vector<int> joint_nodes;  // the node of every joint, none twice
  // joint_from_mesh of every joint at rest; empty when the file has none, which glTF defines as the
  // identity.
  std::vector<Eigen::Matrix4d> inverse_binds;
};

// Reads a skin of 1 to kMaxUserJoints joints.
absl::StatusOr<GlbSkin> ReadGlbSkin(const GlbContainer& glb, const GlbNodes& nodes, size_t skin);

// For every joint, the joint of the skin that is the nearest one above it, or -1.
std::vector<int> ParentJoints(const GlbSkin& skin, const GlbNodes& nodes);

// Returns the indices of `parents` with every parent before its children: first the roots, of which
// there may be several. Roots and children of one parent stay in their order.
std::vector<int> ParentsFirst(const std::vector<int>& parents);

// The name of a node, or an empty text.
std::string GlbNodeName(const GlbContainer& glb, int node);

// Reads the influences of every vertex of a primitive: JOINTS_0 and WEIGHTS_0, and all further
// sets, each of which holds four more. `joint` counts in the skin. Influences without weight are
// left out.
absl::StatusOr<std::vector<std::vector<JointInfluence>>> ReadGlbInfluences(
    const GlbContainer& glb, const nlohmann::json& attributes, size_t num_vertices,
    size_t num_joints);

}  // namespace pleat
