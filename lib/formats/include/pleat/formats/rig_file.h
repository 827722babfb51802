// Rigs that a user brings, as JSON (docs/formats/rig.md) or as the skin of a GLB.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/mesh/input_note.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skinning/user_rig.h"

namespace pleat {

// What a file says, before it is matched to a mesh.
struct RigFile {
  Skeleton skeleton;  // at most 256 joints
  // One list per vertex; empty when the file has no weights.
  std::vector<std::vector<JointInfluence>> influences;
  // True: the influences are those of Pleat's bones, each named by the joint that it ends in.
  // False: they are those of joints, as other programs write them.
  bool influences_are_of_bones = false;
  // Where the weighted vertices of a GLB lie, 3 x N, in the space of the skeleton. Empty: the
  // vertices are those of the clip, in its order.
  Eigen::Matrix3Xd positions;
  // Where the nodes of a GLB place mesh and skeleton, judged by the root. It is only a guess of the
  // unit and the up axis, because the nodes may be posed.
  Eigen::Matrix4d shown_from_mesh = Eigen::Matrix4d::Identity();
  int rest_frame = 0;
  bool is_locked = false;          // locks all joints, including those that are added
  std::vector<int> locked_joints;  // ascending
  std::vector<InputNote> notes;    // what was decided for the user
};

// Reads a rig from hostile JSON. kInvalidArgument says what is wrong and where, kResourceExhausted
// names the limit that is exceeded.
absl::StatusOr<RigFile> DecodeRigJson(std::string_view text, const MeshLimits& limits = {});
// Reads a skin of a hostile binary glTF 2.0 file: its joints with parents before children, rest
// positions from the inverse bind matrices (from the nodes where there are none), and the
// influences of every vertex of the mesh primitives that use the skin, of all their sets (JOINTS_0,
// JOINTS_1, ...). skin: the name or the number of the skin, counted from 0; it may be empty when
// the file has one. The errors are those of DecodeRigJson, also for buffers outside the file and
// for compressed meshes.
absl::StatusOr<RigFile> DecodeRigGlb(std::string_view bytes, const MeshLimits& limits = {},
                                     std::string_view skin = {});
// Reads a GLB, glTF text (.gltf) with its buffers beside it, or JSON. What the bytes are counts
// more than the ending. JSON has no skins, and `skin` is an error there. The errors name the file.
absl::StatusOr<RigFile> ReadRigFile(const std::string& path, const MeshLimits& limits = {},
                                    std::string_view skin = {});

// Returns the rig for the clip's own vertices. What EncodeRig wrote comes back as it was. The
// weights of a GLB are carried over by place: each vertex of the clip takes those of the nearest
// vertex of the file. A GLB that differs from the clip by a rigid motion or a unit is aligned.
// `notes`, which may be null, receives those of the file, how it was aligned and how many
// influences were left out. kInvalidArgument when counts differ, when the meshes do not
// lie on each other within 1 % of the diagonal, or when a joint lies far from the mesh.
absl::StatusOr<UserRig> ResolveRig(const RigFile& given, const MeshSequence& clip,
                                   std::vector<InputNote>* notes = nullptr);

// Locks the joints with these names. kInvalidArgument names the first one that is not there.
absl::Status LockJoints(const std::vector<std::string>& names, RigFile* file);

// Returns the rig as JSON with the weights of bones. DecodeRigJson and ResolveRig give the same rig
// back.
std::string EncodeRig(const UserRig& rig);

}  // namespace pleat
