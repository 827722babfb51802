#include "pleat/skinning/skin_edges.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status CheckParameters(const SkinEdgesParameters& p, int num_vertices) {
  for (const int v : p.vertices) {
    if (v < 0 || v >= num_vertices) {
      return absl::InvalidArgumentError(
          absl::StrCat("skin edges: vertex ", v, " is not in [0, ", num_vertices, ")"));
    }
  }
  if (p.lengths.size() != p.edges.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat("skin edges: ", p.lengths.size(), " lengths for ", p.edges.size(), " edges"));
  }
  const int num_points = static_cast<int>(p.vertices.size());
  for (size_t e = 0; e < p.edges.size(); ++e) {
    const auto [first, second] = p.edges[e];
    if (first < 0 || first >= num_points || second < 0 || second >= num_points || first == second ||
        !(p.lengths[e] > 0) || !std::isfinite(p.lengths[e])) {
      return absl::InvalidArgumentError(
          absl::StrCat("skin edges: edge ", e, " from point ", first, " to ", second, " of ",
                       num_points, " with length ", p.lengths[e], " is out of range"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SkinEdges> SkinEdges::Create(const Rig& rig, SkinEdgesParameters parameters) {
  PLEAT_RETURN_IF_ERROR(CheckParameters(parameters, rig.weights.num_vertices()));
  std::vector<VertexInfluences> influences;
  for (const int v : parameters.vertices) influences.push_back(rig.weights.vertex(v));
  PLEAT_ASSIGN_OR_RETURN(SkinWeights weights,
                         SkinWeights::Create(rig.skeleton.num_joints(), std::move(influences)));
  const Eigen::Matrix3Xd rest = rig.rest_positions(Eigen::all, parameters.vertices);
  return SkinEdges(std::move(parameters), std::move(weights), rest);
}

SkinEdges::SkinEdges(SkinEdgesParameters parameters, SkinWeights weights, Eigen::Matrix3Xd rest)
    : parameters_(std::move(parameters)),
      weights_(std::move(weights)),
      rest_(std::move(rest)),
      all_points_(parameters_.vertices.size()) {
  std::iota(all_points_.begin(), all_points_.end(), 0);
}

size_t SkinEdges::memory_bytes() const {
  return all_points_.size() * (2 * sizeof(int) + sizeof(VertexInfluences) + 3 * sizeof(double)) +
         parameters_.edges.size() * (2 * sizeof(int) + sizeof(float));
}

void SkinEdges::Compute(const BoneTransforms& transforms, Workspace* workspace,
                        Eigen::Ref<Eigen::VectorXf> values) const {
  SkinVertices(weights_, rest_, transforms, &workspace->positions);
  BlendRotations(weights_, all_points_, transforms, &workspace->rotations);
  for (size_t e = 0; e < parameters_.edges.size(); ++e) {
    const auto [first, second] = parameters_.edges[e];
    const Eigen::Vector3d along =
        workspace->positions.col(second) - workspace->positions.col(first);
    const Eigen::Vector3d turned = workspace->rotations[first].conjugate() * along;
    values.segment<3>(3 * static_cast<Eigen::Index>(e)) =
        (turned / parameters_.lengths[e]).cast<float>();
  }
}

}  // namespace pleat
