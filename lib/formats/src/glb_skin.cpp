// Khronos, glTF 2.0 specification, section 3.7.3 (skins).
#include "glb_skin.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

// 16 influences of one vertex, which is more than any exporter writes. All sets may be the same
// bytes, so the number bounds what a small file can unfold to.
constexpr int kMaxSets = 4;

std::string SetName(const char* stem, int set) { return absl::StrCat(stem, "_", set); }

// Adds the influences of one set to those of the vertices.
absl::Status AddSet(const GlbContainer& glb, const json& attributes, int set, size_t num_joints,
                    std::vector<std::vector<JointInfluence>>* influences) {
  const std::string joints_name = SetName("JOINTS", set), weights_name = SetName("WEIGHTS", set);
  if (!attributes.contains(joints_name) || !attributes.contains(weights_name)) {
    return GlbFault(
        absl::StrCat("a primitive has one of ", joints_name, " and ", weights_name, " alone"));
  }
  PLEAT_ASSIGN_OR_RETURN(const GlbAccessor joints, glb.Access(attributes[joints_name], "VEC4"));
  PLEAT_ASSIGN_OR_RETURN(const GlbAccessor weights, glb.Access(attributes[weights_name], "VEC4"));
  if (joints.count() != influences->size() || weights.count() != influences->size()) {
    return GlbFault(absl::StrCat("POSITION, ", joints_name, " and ", weights_name,
                                 " of a primitive differ in length"));
  }
  for (size_t v = 0; v < influences->size(); ++v) {
    for (int k = 0; k < 4; ++k) {
      const double joint = joints.At(v, k), weight = weights.At(v, k);
      if (weight == 0) continue;
      if (!(weight > 0) || !std::isfinite(weight) || !(joint >= 0) ||
          joint >= static_cast<double>(num_joints) || joint != std::floor(joint)) {
        return GlbFault(absl::StrCat("vertex ", v, ": joint ", joint, ", weight ", weight,
                                     " is not an influence of this skin"));
      }
      (*influences)[v].push_back({static_cast<int>(joint), weight});
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<GlbSkin> ReadGlbSkin(const GlbContainer& glb, const GlbNodes& nodes, size_t skin) {
  const json& entry = glb.Entry("skins", skin);
  const json joints = entry.is_object() ? entry.value("joints", json()) : json();
  if (!joints.is_array() || joints.empty() || joints.size() > kMaxUserJoints) {
    return GlbFault(absl::StrCat("a skin must have 1 to ", kMaxUserJoints, " joints"));
  }
  GlbSkin result;
  for (const json& joint : joints) {
    if (!joint.is_number_integer() || joint < 0 || joint >= nodes.count()) {
      return GlbFault("a joint of the skin is not a node");
    }
    result.joint_nodes.push_back(joint.get<int>());
  }
  if (std::set<int>(result.joint_nodes.begin(), result.joint_nodes.end()).size() !=
      result.joint_nodes.size()) {
    return GlbFault("the skin lists a joint twice");
  }
  const auto binds = entry.find("inverseBindMatrices");
  if (binds == entry.end()) return result;
  PLEAT_ASSIGN_OR_RETURN(const GlbAccessor matrices, glb.Access(*binds, "MAT4"));
  if (matrices.count() < joints.size()) return GlbFault("too few inverse bind matrices");
  result.inverse_binds.resize(joints.size());
  for (size_t j = 0; j < joints.size(); ++j) {
    Eigen::Matrix4d& matrix = result.inverse_binds[j];
    for (int k = 0; k < 16; ++k) matrix(k % 4, k / 4) = matrices.At(j, k);
    if (!matrix.allFinite() || std::abs(matrix.determinant()) < 1e-18) {
      return GlbFault(absl::StrCat("inverse bind matrix ", j, " has no inverse"));
    }
  }
  return result;
}

std::vector<int> ParentJoints(const GlbSkin& skin, const GlbNodes& nodes) {
  std::vector<int> joint_of_node(static_cast<size_t>(nodes.count()), -1);
  for (size_t j = 0; j < skin.joint_nodes.size(); ++j) {
    joint_of_node[static_cast<size_t>(skin.joint_nodes[j])] = static_cast<int>(j);
  }
  std::vector<int> parents;
  for (const int joint_node : skin.joint_nodes) {
    int node = nodes.parent(joint_node);
    while (node >= 0 && joint_of_node[static_cast<size_t>(node)] < 0) node = nodes.parent(node);
    parents.push_back(node < 0 ? -1 : joint_of_node[static_cast<size_t>(node)]);
  }
  return parents;
}

std::vector<int> ParentsFirst(const std::vector<int>& parents) {
  const int num_joints = static_cast<int>(parents.size());
  std::vector<std::vector<int>> children(num_joints);
  std::vector<int> order;
  for (int j = 0; j < num_joints; ++j) {
    (parents[j] >= 0 ? children[parents[j]] : order).push_back(j);
  }
  for (size_t i = 0; i < order.size(); ++i) {
    order.insert(order.end(), children[order[i]].begin(), children[order[i]].end());
  }
  return order;
}

std::string GlbNodeName(const GlbContainer& glb, int node) {
  const json& entry = glb.List("nodes")[static_cast<size_t>(node)];
  const auto found = entry.find("name");
  return found != entry.end() && found->is_string() ? found->get<std::string>() : "";
}

absl::StatusOr<std::vector<std::vector<JointInfluence>>> ReadGlbInfluences(const GlbContainer& glb,
                                                                           const json& attributes,
                                                                           size_t num_vertices,
                                                                           size_t num_joints) {
  std::vector<std::vector<JointInfluence>> influences(num_vertices);
  int set = 0;
  for (;
       attributes.contains(SetName("JOINTS", set)) || attributes.contains(SetName("WEIGHTS", set));
       ++set) {
    if (set == kMaxSets) {
      return GlbFault(absl::StrCat("more than ", 4 * kMaxSets, " influences of one vertex"));
    }
    PLEAT_RETURN_IF_ERROR(AddSet(glb, attributes, set, num_joints, &influences));
  }
  if (set == 0) return GlbFault("a primitive of the skinned mesh lacks JOINTS_0 and WEIGHTS_0");
  return influences;
}

}  // namespace pleat
