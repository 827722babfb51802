// Rigs that a user brings, as JSON (docs/formats/rig.md) or as the skin of a GLB.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skinning/user_rig.h"

namespace pleat {

// What a file says, before it is matched to a mesh.
struct RigFile {
  Skeleton skeleton;  // at most 256 joints
  // Per vertex; empty when the file has no weights.
  std::vector<std::vector<JointInfluence>> influences;
  bool influences_are_of_bones = false;  // of Pleat's bones (named by the joint they end in)
  // GLB: where the weighed vertices are, 3 x N, meters. Empty: they are the clip's, in its order.
  Eigen::Matrix3Xd positions;
  int rest_frame = 0;
  bool is_locked = false;          // all joints, those that are added included
  std::vector<int> locked_joints;  // ascending
};

// kInvalidArgument says what is wrong and where; kResourceExhausted names the limit.
absl::StatusOr<RigFile> DecodeRigJson(std::string_view text, const MeshLimits& limits = {});
// The first skin of a binary glTF 2.0 file: its joints in parent-before-child order, rest positions
// from the inverse bind matrices, and the first four influences of every vertex of the mesh
// primitives that use it. kUnimplemented for buffers outside the file and sparse or quantized
// accessors that a skin does not need.
absl::StatusOr<RigFile> DecodeRigGlb(std::string_view bytes, const MeshLimits& limits = {});
// By the ending: .glb or .json.
absl::StatusOr<RigFile> ReadRigFile(const std::string& path, const MeshLimits& limits = {});

// The rig for the clip's own vertices. What EncodeRig wrote comes back as it was. Weights of a GLB
// go to the clip's vertices by place: each takes those of the nearest vertex of the file.
// kInvalidArgument when counts differ, when the meshes do not lie over each other within 1 % of the
// diagonal, or joints lie far from the mesh.
absl::StatusOr<UserRig> ResolveRig(const RigFile& file, const MeshSequence& clip);

// Locks those joints, by name. kInvalidArgument names the first that is not there.
absl::Status LockJoints(const std::vector<std::string>& names, RigFile* file);

// JSON with the weights of bones; DecodeRigJson and ResolveRig give the same rig back.
std::string EncodeRig(const UserRig& rig);

}  // namespace pleat
