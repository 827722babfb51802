// Details: what the mesh does beyond its skinned rig (docs/method/details.md; paper, section
// III-C).
//
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

// The axes B_t(v) in which the detail of a vertex is written.
enum class DetailAxes {
  kWorld,  // the paper's: B = I
  kRoot,   // the rotation of the root: details turn with the body
  kLocal,  // the rotation of the vertex's own blend: details also follow the limbs
};

// Writes B_t(v) of `vertices` to `rotations`, in that order. It does not allocate once `rotations`
// has the right size.
void ComputeDetailRotations(DetailAxes axes, const SkinWeights& weights,
                            const std::vector<int>& vertices, const BoneTransforms& transforms,
                            std::vector<Eigen::Quaterniond>* rotations);

// The positions that details are added to.
enum class DetailBase {
  kSkinned,  // the skinned mesh: details are fine, the paper's choice
  kRoot,     // the rest mesh moved by the root alone: details are the full deformation
};

// Writes the base of all vertices to `positions` (3 x V, meters). It does not allocate once
// `positions` has the right size.
void ComputeDetailBase(DetailBase base, const Rig& rig, const BoneTransforms& transforms,
                       Eigen::Matrix3Xd* positions);

struct ComputeDetailsOptions {
  DetailBase base = DetailBase::kSkinned;
  DetailAxes axes = DetailAxes::kLocal;
  int num_threads = 0;  // 0 = one per core; the result does not depend on it
};

// Returns the details of all frames at `vertices` (C indices) as a T x 3C matrix in meters: row t
// holds x, y, z of the first vertex, of the second, and so on. The error is kInvalidArgument when
// the counts of sequence, rig and track differ or a vertex is out of range, and kCancelled.
absl::StatusOr<Eigen::MatrixXd> ComputeDetails(const MeshSequence& sequence, const Rig& rig,
                                               const PoseTrack& track,
                                               const std::vector<int>& vertices,
                                               const ComputeDetailsOptions& options = {},
                                               const Progress& progress = {});

// The inverse for one frame: column c of `positions` = base_c + rotations[c] * details_c. base: 3 x
// C, meters; rotations: C, from ComputeDetailRotations; details: 3C. `positions` (3 x C) may be the
// matrix behind `base`. It does not allocate once `positions` has the right size.
void ApplyDetails(const Eigen::Ref<const Eigen::Matrix3Xd>& base,
                  const std::vector<Eigen::Quaterniond>& rotations,
                  const Eigen::Ref<const Eigen::VectorXd>& details, Eigen::Matrix3Xd* positions);
void ApplyDetails(const Eigen::Ref<const Eigen::Matrix3Xd>& base,
                  const std::vector<Eigen::Quaterniond>& rotations,
                  const Eigen::Ref<const Eigen::VectorXf>& details, Eigen::Matrix3Xd* positions);

}  // namespace pleat
