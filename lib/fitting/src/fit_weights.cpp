#include "pleat/fitting/fit_weights.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "pleat/base/parallel.h"
#include "pleat/math/spread_rows.h"

namespace pleat {

Eigen::VectorXf ComputeFitWeights(const MeshSequence& sequence, const Rig& rig,
                                  const PoseTrack& track, int num_threads, int max_frames) {
  assert(track.num_frames() == sequence.num_frames());
  const std::vector<Eigen::Index> frames = SpreadRows(sequence.num_frames(), max_frames);
  const int num_frames = static_cast<int>(frames.size());
  // Items have a fixed size, and their sums are added in order, so that the number of threads does
  // not show.
  constexpr int kItemFrames = 16;
  const int num_items = (num_frames + kItemFrames - 1) / kItemFrames;
  std::vector<Eigen::VectorXd> sums(static_cast<size_t>(num_items));
  ParallelFor(num_items, num_threads, [&](int item) {
    sums[item].setZero(sequence.num_vertices());
    BoneTransforms transforms;
    Eigen::Matrix3Xd skinned;
    for (int f = item * kItemFrames; f < std::min(num_frames, (item + 1) * kItemFrames); ++f) {
      const int t = static_cast<int>(frames[f]);
      ComputeBoneTransforms(rig.skeleton, track.pose(t), {}, &transforms);
      SkinVertices(rig.weights, rig.rest_positions, transforms, &skinned);
      sums[item] +=
          (sequence.frame(t).cast<double>() - skinned).colwise().squaredNorm().transpose();
    }
  });
  Eigen::VectorXd residuals = Eigen::VectorXd::Zero(sequence.num_vertices());
  for (const Eigen::VectorXd& sum : sums) residuals += sum;
  const double mean = residuals.mean() / num_frames;
  residuals /= num_frames;
  // What is left of a perfect fit is rounding, which says nothing about a vertex.
  constexpr double kRounding = 1e-6;
  const Eigen::Vector3d center = rig.rest_positions.rowwise().mean();
  const double squared_size =
      (rig.rest_positions.colwise() - center).colwise().squaredNorm().mean();
  if (!(mean > kRounding * kRounding * squared_size)) return {};
  // Three times the mean keeps vertices that happen to fit well from deciding alone: no vertex
  // counts more than four thirds of an average one.
  constexpr double kMeans = 3;
  Eigen::VectorXd weights = (residuals.array() + kMeans * mean).inverse();
  weights /= weights.mean();
  return weights.cast<float>();
}

}  // namespace pleat
