// The steps of rig refinement that work on one vertex at a time while poses and joints are held:
// skinning weights (Le and Deng, "Smooth skinning decomposition with rigid bones", SIGGRAPH Asia
// 2012, section 4.1, with a smoothness term) and rest positions (docs/method/fit.md#rest-mesh).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/fitting/pose_energy.h"
#include "pleat/mesh/adjacency.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// All that the per-vertex problems know about the frames. T_bt (3 x 4) takes [u; 1], u relative to
// the rest center, to where bone b alone would carry it in frame t; y_it is the observed vertex.
struct VertexMoments {
  int num_frames = 0;
  Eigen::Vector3d rest_center = Eigen::Vector3d::Zero();  // meters
  Eigen::MatrixXd pairs;  // 4J x 4J, block bc = sum_t T_bt^T T_ct; blocks of bone 0 are zero
  Eigen::MatrixXd cross;  // 4J x V, block b of column i = sum_t T_bt^T y_it
};

// Computes the sums over frames, the only loop over frames and vertices. `frames` (F) are indices
// into `sequence`; `poses` and `centers` belong to them in order. Only kCancelled is an error.
absl::StatusOr<VertexMoments> ComputeVertexMoments(const MeshSequence& sequence,
                                                   const std::vector<int>& frames,
                                                   const std::vector<ChainPose>& poses,
                                                   const std::vector<Eigen::Vector3d>& centers,
                                                   const Rig& rig, int num_threads,
                                                   const Progress& progress);

struct WeightStepOptions {
  // Both pulls are in units of the squared size of the body (mean squared distance from the
  // center):
  double smoothness = 0;  // pull of a vertex's weights to the mean of its neighbors' weights
  double prior = 0;       // pull to the first weights
  int max_influences = kStandardInfluences;  // bones of a vertex
  int num_sweeps = 3;  // over all vertices, each from the neighbors' weights of the one before
  int num_threads = 0;
};

// Returns the weights of every vertex: at most max_influences bones, non-negative, sum 1. A vertex
// may take bones of its own, of its neighbors, and bones next to its own in the skeleton.
absl::StatusOr<SkinWeights> RefineWeights(const VertexMoments& moments, const Rig& rig,
                                          const SkinWeights& first,
                                          const VertexAdjacency& adjacency,
                                          const WeightStepOptions& options,
                                          const Progress& progress);

struct RestStepOptions {
  double smoothness = 0;  // pull of a vertex's displacement to the mean of its neighbors'
  double prior = 0;       // pull to the first rest positions; both per frame
  int num_sweeps = 3;
  int num_threads = 0;
};

// Returns the rest position (3 x V, meters) of every vertex.
absl::StatusOr<Eigen::Matrix3Xd> RefineRestPositions(const VertexMoments& moments, const Rig& rig,
                                                     const Eigen::Matrix3Xd& first,
                                                     const VertexAdjacency& adjacency,
                                                     const RestStepOptions& options,
                                                     const Progress& progress);

}  // namespace pleat
