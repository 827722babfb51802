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

absl::Status Fault(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("GLB: ", what));
}

std::string SetName(const char* stem, int set) { return absl::StrCat(stem, "_", set); }

// Adds the influences of one set to those of the vertices.
absl::Status AddSet(const GlbContainer& glb, const json& attributes, int set, size_t num_joints,
                    std::vector<std::vector<JointInfluence>>* influences) {
  const std::string joints_name = SetName("JOINTS", set), weights_name = SetName("WEIGHTS", set);
  if (!attributes.contains(joints_name) || !attributes.contains(weights_name)) {
    return Fault(
        absl::StrCat("a primitive has one of ", joints_name, " and ", weights_name, " alone"));
  }
  PLEAT_ASSIGN_OR_RETURN(const GlbAccessor joints, glb.Access(attributes[joints_name], "VEC4"));
  PLEAT_ASSIGN_OR_RETURN(const GlbAccessor weights, glb.Access(attributes[weights_name], "VEC4"));
  if (joints.count() != influences->size() || weights.count() != influences->size()) {
    return Fault(absl::StrCat("POSITION, ", joints_name, " and ", weights_name,
                              " of a primitive differ in length"));
  }
  for (size_t v = 0; v < influences->size(); ++v) {
    for (int k = 0; k < 4; ++k) {
      const double joint = joints.At(v, k), weight = weights.At(v, k);
      if (weight == 0) continue;
      if (!(weight > 0) || !std::isfinite(weight) || !(joint >= 0) ||
          joint >= static_cast<double>(num_joints) || joint != std::floor(joint)) {
        return Fault(absl::StrCat("vertex ", v, ": joint ", joint, ", weight ", weight,
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
    return Fault(absl::StrCat("a skin must have 1 to ", kMaxUserJoints, " joints"));
  }
  GlbSkin result;
  for (const json& joint : joints) {
    if (!joint.is_number_integer() || joint < 0 || joint >= nodes.count()) {
      return Fault("a joint of the skin is not a node");
    }
    result.joint_nodes.push_back(joint.get<int>());
  }
  if (std::set<int>(result.joint_nodes.begin(), result.joint_nodes.end()).size() !=
      result.joint_nodes.size()) {
    return Fault("the skin lists a joint twice");
  }
  const auto binds = entry.find("inverseBindMatrices");
  if (binds == entry.end()) return result;
  PLEAT_ASSIGN_OR_RETURN(const GlbAccessor matrices, glb.Access(*binds, "MAT4"));
  if (matrices.count() < joints.size()) return Fault("too few inverse bind matrices");
  result.inverse_binds.resize(joints.size());
  for (size_t j = 0; j < joints.size(); ++j) {
    Eigen::Matrix4d& matrix = result.inverse_binds[j];
    for (int k = 0; k < 16; ++k) matrix(k % 4, k / 4) = matrices.At(j, k);
    if (!matrix.allFinite() || std::abs(matrix.determinant()) < 1e-18) {
      return Fault(absl::StrCat("inverse bind matrix ", j, " has no inverse"));
    }
  }
  return result;
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
      return Fault(absl::StrCat("more than ", 4 * kMaxSets, " influences of one vertex"));
    }
    PLEAT_RETURN_IF_ERROR(AddSet(glb, attributes, set, num_joints, &influences));
  }
  if (set == 0) return Fault("a primitive of the skinned mesh lacks JOINTS_0 and WEIGHTS_0");
  return influences;
}

}  // namespace pleat
