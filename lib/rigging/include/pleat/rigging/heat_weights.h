// Skinning weights by heat equilibrium on the surface (docs/method/rig.md#heat-weights).
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/geometry/solid_surface.h"
#include "pleat/mesh/topology.h"
#include "pleat/rigging/body_volume.h"
#include "pleat/rigging/bone_visibility.h"
#include "pleat/skeleton/skeleton.h"
#include "pleat/skinning/skin_weights.h"

namespace pleat {

struct HeatWeightsOptions {
  double heat_constant = 1;  // c: larger = bones keep their heat, transitions become sharper
  int num_threads = 1;       // 0 = one per core
  // How far the vertices may lie off the surface that the inside test knows, in the unit of the
  // surface: the last stretch of that length before a vertex hides no bone.
  double surface_tolerance = 0;
  // The diagonal of the body without what floats beside it, in the unit of the surface; 0 = that of
  // the whole surface.
  double body_diagonal = 0;
};

struct HeatWeightsSummary {
  int num_hidden_vertices = 0;  // vertices that see no bone; their neighbors heat them
  int num_cold_components = 0;  // parts without a visible bone: heated by their nearest bones
};

// Solves (-L + H) w_b = H p_b for every bone b (Baran and Popovic 2007, section 4;
// docs/method/rig.md#heat-weights): L is the cotangent Laplacian, H_i = c / d_i^2 at the nearest
// visible bone, p_b = 1 where b is that bone. Each equation is scaled by the vertex's area, so that
// the weights depend neither on unit nor on resolution. A vertex sees a bone when the segment to
// its nearest point stays inside the body. positions: 3 x V, rest pose; skeleton: rest positions in
// the same unit. Vertices without a triangle follow their nearest bone. At most four influences per
// vertex. The error is kInvalidArgument when the mesh has no area or the skeleton no bone, and
// kCancelled.
absl::StatusOr<SkinWeights> ComputeHeatWeights(const Topology& topology,
                                               const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                               const Skeleton& skeleton,
                                               const HeatWeightsOptions& options = {},
                                               HeatWeightsSummary* summary = nullptr,
                                               const Progress& progress = {});

// Does the same for a surface that is already prepared. joints: 3 x J in the surface's unit.
// Returns weights for the surface's own vertices, W x J, not yet cut to four, column 0 zero.
absl::StatusOr<Eigen::MatrixXd> SolveHeatEquilibrium(
    const SolidSurface& surface, const InsideTest& inside, const Skeleton& skeleton,
    const Eigen::Matrix3Xd& joints, const HeatWeightsOptions& options = {},
    HeatWeightsSummary* summary = nullptr, const Progress& progress = {});

// Carries weights of a prepared surface (W x J) to the vertices of the mesh it was made from.
// Weights under a hundredth become 0: heat reaches everywhere, but nobody paints such tails.
// positions: 3 x V, joints: 3 x J, in the same unit.
absl::StatusOr<SkinWeights> WeightsOfInput(const SolidSurface& surface,
                                           const Eigen::MatrixXd& surface_weights,
                                           const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                           const Skeleton& skeleton,
                                           const Eigen::Matrix3Xd& joints);

// Carries weights of the vertices of a shell (W x J) to positions near it (3 x V, in the same
// unit): each takes those of the nearest point. `tree` is that of the shell.
absl::StatusOr<SkinWeights> WeightsFromShell(const BodyShell& shell, const TriangleTree& tree,
                                             const Eigen::MatrixXd& shell_weights,
                                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                             int num_threads);

}  // namespace pleat
