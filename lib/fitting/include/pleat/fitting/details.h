// Details: what the mesh does beyond its skinned rig (docs/method/details.md; paper, section
// III-C).
//   d_t(v) = B_t(v)^T (p_t(v) - p_S,t(v)),  p_S,t the detail base
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// The axes B_t(v) in which a vertex's detail is written.
enum class DetailAxes {
  kWorld,  // the paper's: B = I
  kRoot,   // the rotation of the root: details turn with the body
  kLocal,  // the rotation of the vertex's own blend: details also follow the limbs
};

// B_t(v) of `vertices`, in that order. No allocation once `rotations` has the right size.
void ComputeDetailRotations(DetailAxes axes, const SkinWeights& weights,
                            const std::vector<int>& vertices, const BoneTransforms& transforms,
                            std::vector<Eigen::Quaterniond>* rotations);

// What details are added to.
enum class DetailBase {
  kSkinned,  // the skinned mesh: details are fine, the paper's choice
  kRoot,     // the rest mesh moved by the root alone: details are the full deformation
};

// 3 x V, meters. No allocation once `positions` has the right size.
void ComputeDetailBase(DetailBase base, const Rig& rig, const BoneTransforms& transforms,
                       Eigen::Matrix3Xd* positions);

struct ComputeDetailsOptions {
  DetailBase base = DetailBase::kSkinned;
  DetailAxes axes = DetailAxes::kLocal;
  int num_threads = 0;  // 0 = one per core; the result does not depend on it
};

// Row t: the details of frame t at `vertices` (C indices), meters: x, y, z of the first, of the
// second, ... (T x 3C). kInvalidArgument when the counts of sequence, rig and track differ or a
// vertex is out of range; kCancelled.
absl::StatusOr<Eigen::MatrixXd> ComputeDetails(const MeshSequence& sequence, const Rig& rig,
                                               const PoseTrack& track,
                                               const std::vector<int>& vertices,
                                               const ComputeDetailsOptions& options = {},
                                               const Progress& progress = {});

// The inverse for one frame: column c of `positions` = base_c + rotations[c] * details_c.
// base: 3 x C, meters; rotations: C, of ComputeDetailRotations; details: 3C. `positions` (3 x C)
// may be the matrix behind `base`. No allocation once it has the right size.
void ApplyDetails(const Eigen::Ref<const Eigen::Matrix3Xd>& base,
                  const std::vector<Eigen::Quaterniond>& rotations,
                  const Eigen::Ref<const Eigen::VectorXd>& details, Eigen::Matrix3Xd* positions);
void ApplyDetails(const Eigen::Ref<const Eigen::Matrix3Xd>& base,
                  const std::vector<Eigen::Quaterniond>& rotations,
                  const Eigen::Ref<const Eigen::VectorXf>& details, Eigen::Matrix3Xd* positions);

}  // namespace pleat
