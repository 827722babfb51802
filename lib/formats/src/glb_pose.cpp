// Khronos, glTF 2.0 specification, sections 3.7.2.2 (morph targets) and 3.7.3 (skins).
#include "glb_pose.h"

#include <algorithm>

namespace pleat {
namespace {

// Returns world_from_mesh of every joint of a skin.
std::vector<Eigen::Matrix4d> SkinTransforms(const GlbSkin& skin, const GlbNodes& nodes) {
  std::vector<Eigen::Matrix4d> transforms;
  for (size_t j = 0; j < skin.joint_nodes.size(); ++j) {
    transforms.push_back(nodes.world_from_node(skin.joint_nodes[j]));
    if (!skin.inverse_binds.empty()) transforms.back() *= skin.inverse_binds[j];
  }
  return transforms;
}

// Normalizes the weights, since those of whole numbers miss a sum of one by their rounding.
Eigen::Matrix4d Blend(const std::vector<JointInfluence>& influences,
                      const std::vector<Eigen::Matrix4d>& transforms) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  double total = 0;
  for (const auto& [joint, weight] : influences) {
    sum += weight * transforms[static_cast<size_t>(joint)];
    total += weight;
  }
  return sum / total;
}

void AddTarget(const GlbAccessor& target, double weight, Eigen::Matrix3Xd* sum) {
  if (const float* deltas = target.Floats()) {
    for (Eigen::Index i = 0; i < sum->size(); ++i) sum->data()[i] += weight * double{deltas[i]};
    return;
  }
  for (Eigen::Index v = 0; v < sum->cols(); ++v) {
    for (int k = 0; k < 3; ++k) (*sum)(k, v) += weight * target.At(static_cast<size_t>(v), k);
  }
}

// The targets that move something.
std::vector<size_t> ActiveTargets(const GlbPart& part, const std::vector<float>& weights) {
  std::vector<size_t> active;
  for (size_t i = 0; i < std::min(part.targets.size(), weights.size()); ++i) {
    if (part.targets[i] && weights[i] != 0) active.push_back(i);
  }
  return active;
}

Eigen::Matrix3Xd Morph(const GlbPart& part, const std::vector<size_t>& active,
                       const std::vector<float>& weights) {
  Eigen::Matrix3Xd sum = part.positions;
  for (const size_t i : active) AddTarget(*part.targets[i], weights[i], &sum);
  return sum;
}

// A part that no node moves: one target at a time is what animations of one target for each frame
// ask for. The sums are rounded once.
void PlaceUnmoved(const GlbPart& part, const std::vector<size_t>& active,
                  const std::vector<float>& weights, Eigen::Ref<Eigen::Matrix3Xf> placed) {
  const float* deltas = active.size() == 1 ? part.targets[active[0]]->Floats() : nullptr;
  if (deltas == nullptr) {
    placed = Morph(part, active, weights).cast<float>();
    return;
  }
  const double weight = weights[active[0]];
  const double* from = part.positions.data();
  float* to = placed.data();  // columns of three rows without gaps
  for (Eigen::Index i = 0; i < placed.size(); ++i) {
    to[i] = static_cast<float>(from[i] + weight * double{deltas[i]});
  }
}

}  // namespace

Eigen::Matrix3Xf PlaceGlbMesh(const GlbMesh& mesh, const GlbNodes& nodes,
                              const std::vector<std::vector<float>>& weights) {
  std::vector<std::vector<Eigen::Matrix4d>> skin_transforms;
  for (const GlbSkin& skin : mesh.skins) skin_transforms.push_back(SkinTransforms(skin, nodes));
  Eigen::Matrix3Xf placed(3, mesh.topology.num_vertices());
  for (size_t p = 0; p < mesh.parts.size(); ++p) {
    const GlbPart& part = mesh.parts[p];
    auto place = placed.middleCols(part.first_vertex, part.positions.cols());
    const std::vector<float> none;
    const std::vector<float>& part_weights = p < weights.size() ? weights[p] : none;
    const std::vector<size_t> active = ActiveTargets(part, part_weights);
    const Eigen::Matrix4d& world_from_node = nodes.world_from_node(part.node);
    if (part.skin < 0 && world_from_node == Eigen::Matrix4d::Identity()) {
      PlaceUnmoved(part, active, part_weights, place);
      continue;
    }
    const Eigen::Matrix3Xd positions = Morph(part, active, part_weights);
    for (Eigen::Index v = 0; v < positions.cols(); ++v) {
      Eigen::Matrix4d world_from_mesh = world_from_node;
      if (part.skin >= 0 && !part.influences[static_cast<size_t>(v)].empty()) {
        world_from_mesh = Blend(part.influences[static_cast<size_t>(v)],
                                skin_transforms[static_cast<size_t>(part.skin)]);
      }
      place.col(v) = (world_from_mesh.topLeftCorner<3, 3>() * positions.col(v) +
                      world_from_mesh.topRightCorner<3, 1>())
                         .cast<float>();
    }
  }
  return placed;
}

}  // namespace pleat
