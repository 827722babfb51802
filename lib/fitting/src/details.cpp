#include "pleat/fitting/details.h"

#include <algorithm>
#include <cassert>

#include "absl/strings/str_cat.h"
#include "input_check.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status CheckDetailsInput(const MeshSequence& sequence, const Rig& rig, const PoseTrack& track,
                               const std::vector<int>& vertices) {
  PLEAT_RETURN_IF_ERROR(CheckRigOfSequence("details", sequence, rig));
  PLEAT_RETURN_IF_ERROR(CheckTrackOfSequence("details", sequence, rig, track));
  for (const int v : vertices) {
    if (v < 0 || v >= sequence.num_vertices()) {
      return absl::InvalidArgumentError(
          absl::StrCat("details: vertex ", v, " is not in [0, ", sequence.num_vertices(), ")"));
    }
  }
  return absl::OkStatus();
}

// The base of one vertex, moved by the root or by linear blend skinning. Training asks for a few
// vertices of many frames, where ComputeDetailBase would skin them all.
Eigen::Vector3d BaseOfVertex(DetailBase base, const Rig& rig, const BoneTransforms& transforms,
                             int v) {
  if (base == DetailBase::kRoot) {
    return transforms.linear[0] * rig.rest_positions.col(v) + transforms.translation[0];
  }
  const VertexInfluences& influences = rig.weights.vertex(v);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (int k = 0; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
    const int b = influences.bones[k];
    position += influences.weights[k] *
                (transforms.linear[b] * rig.rest_positions.col(v) + transforms.translation[b]);
  }
  return position;
}

template <typename Vector>
void Apply(const Eigen::Ref<const Eigen::Matrix3Xd>& base,
           const std::vector<Eigen::Quaterniond>& rotations, const Vector& details,
           Eigen::Matrix3Xd* positions) {
  const Eigen::Index count = base.cols();
  assert(details.size() == 3 * count && static_cast<Eigen::Index>(rotations.size()) == count);
  positions->resize(3, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const Eigen::Vector3d detail = details.template segment<3>(3 * c).template cast<double>();
    positions->col(c) = base.col(c) + rotations[c] * detail;
  }
}

}  // namespace

void ComputeDetailRotations(DetailAxes axes, const SkinWeights& weights,
                            const std::vector<int>& vertices, const BoneTransforms& transforms,
                            std::vector<Eigen::Quaterniond>* rotations) {
  switch (axes) {
    case DetailAxes::kWorld:
      rotations->assign(vertices.size(), Eigen::Quaterniond::Identity());
      return;
    case DetailAxes::kRoot:
      rotations->assign(vertices.size(), Eigen::Quaterniond(transforms.rotation[0]));
      return;
    case DetailAxes::kLocal:
      BlendRotations(weights, vertices, transforms, rotations);
      return;
  }
}

void ComputeDetailBase(DetailBase base, const Rig& rig, const BoneTransforms& transforms,
                       Eigen::Matrix3Xd* positions) {
  if (base == DetailBase::kSkinned) {
    SkinVertices(rig.weights, rig.rest_positions, transforms, positions);
    return;
  }
  positions->noalias() = transforms.linear[0] * rig.rest_positions;
  positions->colwise() += transforms.translation[0];
}

absl::StatusOr<Eigen::MatrixXd> ComputeDetails(const MeshSequence& sequence, const Rig& rig,
                                               const PoseTrack& track,
                                               const std::vector<int>& vertices,
                                               const ComputeDetailsOptions& options,
                                               const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckDetailsInput(sequence, rig, track, vertices));
  constexpr int kBatch = 64;  // frames between two reports of progress
  const int num_frames = sequence.num_frames();
  Eigen::MatrixXd details(num_frames, 3 * vertices.size());
  for (int begin = 0; begin < num_frames; begin += kBatch) {
    const int size = std::min(kBatch, num_frames - begin);
    ParallelFor(size, options.num_threads, [&](int item) {
      if (progress.cancelled()) return;
      const int t = begin + item;
      BoneTransforms transforms;
      ComputeBoneTransforms(rig.skeleton, track.pose(t), {}, &transforms);
      std::vector<Eigen::Quaterniond> rotations;
      ComputeDetailRotations(options.axes, rig.weights, vertices, transforms, &rotations);
      for (size_t c = 0; c < vertices.size(); ++c) {
        const int v = vertices[c];
        const Eigen::Vector3d offset = sequence.frame(t).col(v).cast<double>() -
                                       BaseOfVertex(options.base, rig, transforms, v);
        details.block<1, 3>(t, 3 * c) = (rotations[c].conjugate() * offset).transpose();
      }
    });
    PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(begin + size) / num_frames));
  }
  return details;
}

void ApplyDetails(const Eigen::Ref<const Eigen::Matrix3Xd>& base,
                  const std::vector<Eigen::Quaterniond>& rotations,
                  const Eigen::Ref<const Eigen::VectorXd>& details, Eigen::Matrix3Xd* positions) {
  Apply(base, rotations, details, positions);
}

void ApplyDetails(const Eigen::Ref<const Eigen::Matrix3Xd>& base,
                  const std::vector<Eigen::Quaterniond>& rotations,
                  const Eigen::Ref<const Eigen::VectorXf>& details, Eigen::Matrix3Xd* positions) {
  Apply(base, rotations, details, positions);
}

}  // namespace pleat
