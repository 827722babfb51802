// Reads the skin of a binary glTF 2.0 file (Khronos, glTF 2.0 specification, sections 3.6 to 3.8
// and 4.4). Only what a rig needs is read, and every index is checked here. A general loader would
// also follow paths and decode images of a file that may be hostile.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "glb_container.h"
#include "pleat/base/status.h"
#include "pleat/formats/rig_file.h"

namespace pleat {
namespace {

using nlohmann::json;

absl::Status Fault(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("GLB: ", what));
}

// Returns the transform of one node relative to its parent.
absl::StatusOr<Eigen::Matrix4d> LocalTransform(const json& node) {
  const auto numbers = [&node](const char* key, size_t count, double fallback,
                               std::vector<double>* values) {
    values->assign(count, fallback);
    const auto found = node.find(key);
    if (found == node.end()) return true;
    if (!found->is_array() || found->size() != count) return false;
    for (size_t k = 0; k < count; ++k) {
      if (!(*found)[k].is_number()) return false;
      (*values)[k] = (*found)[k].get<double>();
      if (!std::isfinite((*values)[k])) return false;
    }
    return true;
  };
  std::vector<double> matrix, move, turn, scale;
  if (node.contains("matrix")) {
    if (!numbers("matrix", 16, 0, &matrix)) return Fault("a node's matrix is not 16 numbers");
    return Eigen::Matrix4d(Eigen::Map<const Eigen::Matrix4d>(matrix.data()));
  }
  if (!numbers("translation", 3, 0, &move) || !numbers("scale", 3, 1, &scale) ||
      !numbers("rotation", 4, 0, &turn)) {
    return Fault("a node's translation, rotation or scale is not a list of finite numbers");
  }
  Eigen::Quaterniond rotation(turn[3], turn[0], turn[1], turn[2]);
  if (!node.contains("rotation")) rotation.setIdentity();
  if (!(rotation.norm() > 0)) return Fault("a node's rotation is zero");
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  transform.translate(Eigen::Vector3d(move[0], move[1], move[2]));
  transform.rotate(rotation.normalized());
  transform.scale(Eigen::Vector3d(scale[0], scale[1], scale[2]));
  return transform.matrix();
}

std::string SkinName(const json& skin) {
  const auto name = skin.is_object() ? skin.find("name") : skin.end();
  return skin.is_object() && name != skin.end() && name->is_string() ? name->get<std::string>()
                                                                     : std::string();
}

// Returns the index of the skin with this name or else this number. An empty text is enough when
// the file has one skin.
absl::StatusOr<size_t> ChooseSkin(const json& skins, const std::string& choice) {
  constexpr size_t kMaxNamed = 8;
  if (skins.empty()) return Fault("the file has no skin: export the armature with the mesh");
  if (choice.empty() && skins.size() == 1) return 0;
  size_t chosen = skins.size(), num_named = 0;
  for (size_t s = 0; !choice.empty() && s < skins.size(); ++s) {
    if (SkinName(skins[s]) != choice) continue;
    chosen = s;
    ++num_named;
  }
  if (num_named == 1) return chosen;
  if (num_named == 0 && absl::SimpleAtoi(choice, &chosen) && chosen < skins.size()) return chosen;
  std::string list;
  for (size_t s = 0; s < std::min(kMaxNamed, skins.size()); ++s) {
    absl::StrAppend(&list, s > 0 ? ", " : "", s, " '", SkinName(skins[s]), "'");
  }
  if (skins.size() > kMaxNamed) absl::StrAppend(&list, ", ...");
  const std::string fault =
      choice.empty() ? "" : absl::StrCat("--skin '", choice, "' is not one: ");
  return Fault(absl::StrCat(fault, "the file has ", skins.size(), " skins: ", list,
                            "; choose one by name or number with --skin"));
}

// Reads nodes, skin, skeleton and meshes, in this order, because each needs the one before. Mesh
// and joints stay in the space of the mesh, in which the inverse bind matrices place the joints at
// rest. Nodes only show the pose in which the file was saved, and glTF ignores the transform of a
// node whose mesh is skinned.
class SkinReader {
 public:
  SkinReader(const GlbContainer& glb, const MeshLimits& limits) : glb_(glb), limits_(limits) {}

  absl::StatusOr<RigFile> Read(std::string_view skin) {
    PLEAT_RETURN_IF_ERROR(ReadNodes());
    PLEAT_ASSIGN_OR_RETURN(skin_, ChooseSkin(glb_.List("skins"), std::string(skin)));
    PLEAT_RETURN_IF_ERROR(ReadSkin());
    PLEAT_RETURN_IF_ERROR(MakeSkeleton());
    PLEAT_RETURN_IF_ERROR(ReadMeshes());
    return std::move(file_);
  }

 private:
  absl::Status ReadNodes() {
    const json& nodes = glb_.List("nodes");
    parents_.assign(nodes.size(), -1);
    for (size_t n = 0; n < nodes.size(); ++n) {
      if (!nodes[n].is_object()) return Fault(absl::StrCat("node ", n, " is not an object"));
      const json children = nodes[n].value("children", json::array());
      if (!children.is_array()) return Fault(absl::StrCat("node ", n, ": bad children"));
      for (const json& child : children) {
        if (!child.is_number_integer() || child < 0 || child >= nodes.size() ||
            parents_[child.get<size_t>()] >= 0) {
          return Fault(absl::StrCat("node ", n, ": a child is out of range or has two parents"));
        }
        parents_[child.get<size_t>()] = static_cast<int>(n);
      }
    }
    // Every node has at most one parent by now, but there may be cycles, on which the walks up to
    // the root would never end.
    for (size_t n = 0; n < nodes.size(); ++n) {
      size_t steps = 0;
      for (int a = parents_[n]; a >= 0; a = parents_[a]) {
        if (++steps > nodes.size()) return Fault(absl::StrCat("node ", n, " is its own ancestor"));
      }
    }
    return absl::OkStatus();
  }

  absl::StatusOr<Eigen::Matrix4d> GlobalTransform(int node) const {
    Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
    for (; node >= 0; node = parents_[node]) {
      PLEAT_ASSIGN_OR_RETURN(const Eigen::Matrix4d local, LocalTransform(glb_.List("nodes")[node]));
      transform = local * transform;
    }
    return transform;
  }

  absl::Status ReadSkin() {
    const json& skin = glb_.List("skins")[skin_];
    const json joints = skin.is_object() ? skin.value("joints", json()) : json();
    if (!joints.is_array() || joints.size() < 2 || joints.size() > kMaxUserJoints) {
      return Fault(absl::StrCat("the skin must have 2 to ", kMaxUserJoints, " joints"));
    }
    for (const json& joint : joints) {
      if (!joint.is_number_integer() || joint < 0 || joint >= parents_.size()) {
        return Fault("a joint of the skin is not a node");
      }
      joint_nodes_.push_back(joint.get<int>());
    }
    if (std::set<int>(joint_nodes_.begin(), joint_nodes_.end()).size() != joint_nodes_.size()) {
      return Fault("the skin lists a joint twice");
    }
    if (!skin.contains("inverseBindMatrices")) return absl::OkStatus();
    PLEAT_ASSIGN_OR_RETURN(const GlbAccessor matrices,
                           glb_.Access(skin["inverseBindMatrices"], "MAT4"));
    if (matrices.count() < joint_nodes_.size()) return Fault("too few inverse bind matrices");
    inverse_binds_.resize(joint_nodes_.size());
    for (size_t j = 0; j < joint_nodes_.size(); ++j) {
      for (int k = 0; k < 16; ++k) inverse_binds_[j](k % 4, k / 4) = matrices.At(j, k);
      if (!inverse_binds_[j].allFinite() || std::abs(inverse_binds_[j].determinant()) < 1e-18) {
        return Fault(absl::StrCat("inverse bind matrix ", j, " has no inverse"));
      }
    }
    return absl::OkStatus();
  }

  // Returns the index in the skin of the nearest ancestor that is a joint, or -1.
  int ParentJoint(int joint) const {
    for (int node = parents_[joint_nodes_[joint]]; node >= 0; node = parents_[node]) {
      const auto found = std::ranges::find(joint_nodes_, node);
      if (found != joint_nodes_.end()) return static_cast<int>(found - joint_nodes_.begin());
    }
    return -1;
  }

  // Returns the indices of the skin with every parent before its children. Children of one parent
  // stay in the order of the skin.
  absl::StatusOr<std::vector<int>> ParentsFirst() const {
    const int num_joints = static_cast<int>(joint_nodes_.size());
    std::vector<std::vector<int>> children(num_joints);
    std::vector<int> order;
    for (int j = 0; j < num_joints; ++j) {
      const int parent = ParentJoint(j);
      if (parent >= 0) {
        children[parent].push_back(j);
      } else if (order.empty()) {
        order.push_back(j);
      } else {
        return Fault("the skin has two roots: join them under one joint");
      }
    }
    for (size_t i = 0; i < order.size(); ++i) {
      order.insert(order.end(), children[order[i]].begin(), children[order[i]].end());
    }
    return order;
  }

  std::string UniqueName(int joint, const std::vector<Joint>& before) const {
    const json& node = glb_.List("nodes")[joint_nodes_[joint]];
    const auto found = node.find("name");
    std::string name = found != node.end() && found->is_string() ? found->get<std::string>() : "";
    if (name.empty()) name = absl::StrCat("joint_", joint_nodes_[joint]);
    const std::string stem = name;
    const auto is_taken = [&] {
      return std::ranges::any_of(before, [&](const Joint& other) { return other.name == name; });
    };
    for (int k = 2; is_taken(); ++k) name = absl::StrCat(stem, "_", k);
    return name;
  }

  absl::Status MakeSkeleton() {
    PLEAT_ASSIGN_OR_RETURN(const std::vector<int> order, ParentsFirst());
    new_index_.assign(joint_nodes_.size(), -1);
    if (!inverse_binds_.empty()) {
      // Nodes may be posed, so this is only where a mesh in another place or unit may be.
      PLEAT_ASSIGN_OR_RETURN(const Eigen::Matrix4d root, GlobalTransform(joint_nodes_[order[0]]));
      file_.shown_from_mesh = root * inverse_binds_[order[0]];
    }
    std::vector<Joint> joints;
    for (const int j : order) {
      new_index_[j] = static_cast<int>(joints.size());
      const int parent = ParentJoint(j);
      Eigen::Matrix4d mesh_from_joint;
      if (inverse_binds_.empty()) {
        PLEAT_ASSIGN_OR_RETURN(mesh_from_joint, GlobalTransform(joint_nodes_[j]));
      } else {
        mesh_from_joint = inverse_binds_[j].inverse();
      }
      joints.push_back({UniqueName(j, joints), parent < 0 ? -1 : new_index_[parent],
                        mesh_from_joint.col(3).hnormalized()});
    }
    absl::StatusOr<Skeleton> skeleton = Skeleton::Create(std::move(joints));
    if (!skeleton.ok()) return Fault(std::string(skeleton.status().message()));
    file_.skeleton = *std::move(skeleton);
    return absl::OkStatus();
  }

  absl::Status ReadMeshes() {
    std::vector<Eigen::Vector3d> positions;
    for (const json& node : glb_.List("nodes")) {
      if (!node.contains("mesh") || node.value("skin", json()) != skin_) continue;
      const json& mesh = glb_.Entry("meshes", node["mesh"]);
      const json primitives = mesh.is_object() ? mesh.value("primitives", json()) : json();
      if (!primitives.is_array()) return Fault("a mesh has no primitives");
      for (const json& primitive : primitives) {
        PLEAT_RETURN_IF_ERROR(ReadPrimitive(primitive, &positions));
      }
    }
    if (positions.empty()) return Fault("no mesh uses the skin");
    file_.positions.resize(3, static_cast<Eigen::Index>(positions.size()));
    for (size_t v = 0; v < positions.size(); ++v) {
      file_.positions.col(static_cast<Eigen::Index>(v)) = positions[v];
    }
    return absl::OkStatus();
  }

  absl::Status ReadPrimitive(const json& primitive, std::vector<Eigen::Vector3d>* positions) {
    const json attributes =
        primitive.is_object() ? primitive.value("attributes", json::object()) : json::object();
    if (!attributes.is_object() || !attributes.contains("POSITION") ||
        !attributes.contains("JOINTS_0") || !attributes.contains("WEIGHTS_0")) {
      return Fault("a primitive of the skinned mesh lacks POSITION, JOINTS_0 or WEIGHTS_0");
    }
    PLEAT_ASSIGN_OR_RETURN(const GlbAccessor points, glb_.Access(attributes["POSITION"], "VEC3"));
    PLEAT_ASSIGN_OR_RETURN(const GlbAccessor joints, glb_.Access(attributes["JOINTS_0"], "VEC4"));
    PLEAT_ASSIGN_OR_RETURN(const GlbAccessor weights, glb_.Access(attributes["WEIGHTS_0"], "VEC4"));
    if (joints.count() != points.count() || weights.count() != points.count()) {
      return Fault("POSITION, JOINTS_0 and WEIGHTS_0 of a primitive differ in length");
    }
    if (positions->size() + points.count() > static_cast<size_t>(limits_.max_vertices)) {
      return absl::ResourceExhaustedError(
          absl::StrCat("GLB: more than ", limits_.max_vertices, " vertices"));
    }
    for (size_t v = 0; v < points.count(); ++v) {
      const Eigen::Vector3d point(points.At(v, 0), points.At(v, 1), points.At(v, 2));
      if (!point.allFinite()) return Fault(absl::StrCat("position ", v, " is not finite"));
      positions->push_back(point);
      std::vector<JointInfluence> influences;
      for (int k = 0; k < 4; ++k) {
        const double joint = joints.At(v, k), weight = weights.At(v, k);
        if (weight == 0) continue;
        if (!(weight > 0) || !std::isfinite(weight) || !(joint >= 0) ||
            joint >= static_cast<double>(new_index_.size()) || joint != std::floor(joint)) {
          return Fault(absl::StrCat("vertex ", v, ": joint ", joint, ", weight ", weight,
                                    " is not an influence of this skin"));
        }
        influences.push_back({new_index_[static_cast<size_t>(joint)], weight});
      }
      file_.influences.push_back(std::move(influences));
    }
    return absl::OkStatus();
  }

  const GlbContainer& glb_;
  const MeshLimits& limits_;
  size_t skin_ = 0;
  std::vector<int> parents_;      // the parent of every node, -1 = none
  std::vector<int> joint_nodes_;  // the node of every joint of the skin
  // joint_from_mesh of every joint of the skin, at rest; empty when the file has none.
  std::vector<Eigen::Matrix4d> inverse_binds_;
  std::vector<int> new_index_;  // the index in file_.skeleton of every joint of the skin
  RigFile file_;
};

}  // namespace

absl::StatusOr<RigFile> DecodeRigGlb(std::string_view bytes, const MeshLimits& limits,
                                     std::string_view skin) {
  if (bytes.size() > limits.max_document_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("GLB: ", bytes.size(), " bytes; the limit is ", limits.max_document_bytes));
  }
  PLEAT_ASSIGN_OR_RETURN(const GlbContainer glb, GlbContainer::Open(bytes));
  return SkinReader(glb, limits).Read(skin);
}

}  // namespace pleat
