// A small figure whose rig, poses and details are known: tubes around the bones of the human
// template, smooth weights, smooth motion. Synthetic truth for skinning, fitting and learning.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/human_template.h"
#include "pleat/skeleton/pose.h"
#include "pleat/skinning/rig.h"
#include "support/smooth_poses.h"

namespace pleat {

struct SkinnedFigure {
  Topology topology;
  Rig rig;
};

struct SkinnedFigureOptions {
  double height_m = 1.7;
  double radius_m = 0.05;
  int num_rings = 6;  // along every bone
  int num_sides = 6;  // around every bone
};

// The 18-joint template at `height_m` with an open tube around each of its 17 bones: every tube is
// a component of its own. V = 17 * num_rings * num_sides.
inline SkinnedFigure MakeSkinnedFigure(const SkinnedFigureOptions& options = {}) {
  const Skeleton& human = HumanTemplate();
  SkinnedFigure figure;
  figure.rig.skeleton = human.WithRestPositions(options.height_m * human.RestPositions());
  const Skeleton& skeleton = figure.rig.skeleton;
  const int num_bones = skeleton.num_joints() - 1;
  const int per_bone = options.num_rings * options.num_sides;
  figure.rig.rest_positions.resize(3, num_bones * per_bone);
  std::vector<int32_t> corners, sizes;
  for (int b = 1; b <= num_bones; ++b) {
    const Eigen::Vector3d head = skeleton.rest_position(skeleton.parent(b));
    const Eigen::Vector3d bone = skeleton.rest_position(b) - head;
    const Eigen::Vector3d side = bone.cross(Eigen::Vector3d(0.3, 0.2, 1)).normalized();
    const Eigen::Vector3d other = bone.normalized().cross(side);
    for (int ring = 0; ring < options.num_rings; ++ring) {
      for (int s = 0; s < options.num_sides; ++s) {
        const double angle = 2 * 3.14159265358979 * s / options.num_sides;
        const int v = (b - 1) * per_bone + ring * options.num_sides + s;
        const int next = v - s + (s + 1) % options.num_sides;
        figure.rig.rest_positions.col(v) =
            head + (ring + 0.5) / options.num_rings * bone +
            options.radius_m * (std::cos(angle) * side + std::sin(angle) * other);
        if (ring + 1 == options.num_rings) continue;
        corners.insert(corners.end(), {v, next, next + options.num_sides, v + options.num_sides});
        sizes.push_back(4);
      }
    }
  }
  figure.topology = *Topology::Create(num_bones * per_bone, corners, sizes);

  // Weights fall off smoothly with the distance to the bone, among the bones that meet.
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(num_bones * per_bone, num_bones + 1);
  for (int v = 0; v < dense.rows(); ++v) {
    const int own = v / per_bone + 1;
    for (int b = 1; b <= num_bones; ++b) {
      const bool meets = b == own || skeleton.parent(b) == own || skeleton.parent(own) == b;
      if (!meets) continue;
      const Eigen::Vector3d head = skeleton.rest_position(skeleton.parent(b));
      const Eigen::Vector3d bone = skeleton.rest_position(b) - head;
      const Eigen::Vector3d offset = figure.rig.rest_positions.col(v) - head;
      const double along = std::clamp(offset.dot(bone) / bone.squaredNorm(), 0.0, 1.0);
      const double excess = (offset - along * bone).norm() / options.radius_m - 1;
      dense(v, b) = b == own ? 1 : std::exp(-0.5 * std::max(0.0, excess) * std::max(0.0, excess));
    }
  }
  figure.rig.weights = *SkinWeights::FromDense(dense);
  return figure;
}

// T x 3V details in each vertex's own axes, meters: a traveling wave over the surface.
inline Eigen::MatrixXd MakeWaveDetails(const SkinnedFigure& figure, int num_frames,
                                       double amplitude_m = 0.005) {
  const Eigen::Matrix3Xd& rest = figure.rig.rest_positions;
  Eigen::MatrixXd details(num_frames, 3 * rest.cols());
  for (int t = 0; t < num_frames; ++t) {
    for (Eigen::Index v = 0; v < rest.cols(); ++v) {
      const double phase = 6 * rest(0, v) + 9 * rest(1, v) + 0.2 * t;
      details.block<1, 3>(t, 3 * v) =
          amplitude_m * Eigen::RowVector3d(std::sin(phase), std::cos(phase), std::sin(2 * phase));
    }
  }
  return details;
}

// Skins `figure` along `track`; `local_details` (T x 3V, or empty for none) are added in each
// vertex's own axes.
inline MeshSequence MakeSkinnedSequence(const SkinnedFigure& figure, const PoseTrack& track,
                                        const Eigen::MatrixXd& local_details = {}) {
  std::vector<int> all(figure.topology.num_vertices());
  for (size_t v = 0; v < all.size(); ++v) all[v] = static_cast<int>(v);
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < track.num_frames(); ++t) {
    BoneTransforms transforms;
    ComputeBoneTransforms(figure.rig.skeleton, track.pose(t), {}, &transforms);
    Eigen::Matrix3Xd positions;
    SkinVertices(figure.rig.weights, figure.rig.rest_positions, transforms, &positions);
    if (local_details.size() > 0) {
      std::vector<Eigen::Quaterniond> rotations;
      BlendRotations(figure.rig.weights, all, transforms, &rotations);
      for (size_t v = 0; v < all.size(); ++v) {
        positions.col(v) += rotations[v] * local_details.block<1, 3>(t, 3 * v).transpose();
      }
    }
    frames.push_back(positions.cast<float>());
  }
  return *MeshSequence::Create(figure.topology, std::move(frames), {.name = "figure"});
}

}  // namespace pleat
