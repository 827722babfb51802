#include "pleat/skinning/cut_influences.h"

#include <cassert>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace pleat {

SkinWeights CutInfluences(const SkinWeights& weights, int max_influences) {
  assert(max_influences >= 1 && max_influences <= kMaxInfluences);
  std::vector<VertexInfluences> influences = weights.influences();
  for (VertexInfluences& vertex : influences) {
    if (max_influences == kMaxInfluences || !(vertex.weights[max_influences] > 0)) continue;
    std::map<int, double> kept;
    for (int k = 0; k < max_influences; ++k) kept[vertex.bones[k]] = vertex.weights[k];
    vertex = StrongestInfluences(kept);
  }
  return SkinWeights::Create(weights.num_joints(), std::move(influences)).value();
}

InfluenceCutError MeasureInfluenceCut(const Rig& rig, const SkinWeights& other,
                                      const PoseTrack& track) {
  assert(other.num_vertices() == rig.weights.num_vertices());
  InfluenceCutError error;
  for (int v = 0; v < other.num_vertices(); ++v) {
    error.num_vertices += other.vertex(v).weights != rig.weights.vertex(v).weights;
  }
  if (error.num_vertices == 0) return error;
  BoneTransforms transforms;
  Eigen::Matrix3Xd before, after;
  double sum = 0, largest = 0;
  for (int t = 0; t < track.num_frames(); ++t) {
    ComputeBoneTransforms(rig.skeleton, track.pose(t), {}, &transforms);
    SkinVertices(rig.weights, rig.rest_positions, transforms, &before);
    SkinVertices(other, rig.rest_positions, transforms, &after);
    const Eigen::RowVectorXd squared = (after - before).colwise().squaredNorm();
    sum += squared.sum();
    Eigen::Index vertex = 0;
    if (const double most = squared.maxCoeff(&vertex); most > largest) {
      largest = most;
      error.worst_frame = t;
      error.worst_vertex = static_cast<int>(vertex);
    }
  }
  const double count = static_cast<double>(track.num_frames()) * other.num_vertices();
  error.rms_m = count > 0 ? std::sqrt(sum / count) : 0;
  error.max_m = std::sqrt(largest);
  return error;
}

}  // namespace pleat
