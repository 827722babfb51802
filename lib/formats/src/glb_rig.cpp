// Reads the skin of a binary glTF 2.0 file (Khronos, glTF 2.0 specification, sections 3.6 to 3.8
// and 4.4). Only what a rig needs is read, and every index is checked here. A general loader would
// also follow paths and decode images of a file that may be hostile.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "bone_joints.h"
#include "glb_container.h"
#include "glb_nodes.h"
#include "glb_skin.h"
#include "pleat/base/status.h"
#include "pleat/formats/rig_file.h"

namespace pleat {
namespace {

using nlohmann::json;

std::string SkinName(const json& skin) {
  const auto name = skin.is_object() ? skin.find("name") : skin.end();
  return skin.is_object() && name != skin.end() && name->is_string() ? name->get<std::string>()
                                                                     : std::string();
}

// Returns the index of the skin with this name or else this number. An empty text is enough when
// the file has one skin.
absl::StatusOr<size_t> ChooseSkin(const json& skins, const std::string& choice) {
  constexpr size_t kMaxNamed = 8;
  if (skins.empty()) return GlbFault("the file has no skin: export the armature with the mesh");
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
  return GlbFault(absl::StrCat(fault, "the file has ", skins.size(),
                               skins.size() == 1 ? " skin: " : " skins: ", list,
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
    PLEAT_ASSIGN_OR_RETURN(nodes_, GlbNodes::Read(glb_));
    PLEAT_ASSIGN_OR_RETURN(skin_index_, ChooseSkin(glb_.List("skins"), std::string(skin)));
    PLEAT_ASSIGN_OR_RETURN(skin_, ReadGlbSkin(glb_, nodes_, skin_index_));
    if (skin_.joint_nodes.size() < 2) {
      return GlbFault(absl::StrCat("the skin must have 2 to ", kMaxUserJoints, " joints"));
    }
    PLEAT_RETURN_IF_ERROR(MakeSkeleton());
    PLEAT_RETURN_IF_ERROR(ReadMeshes());
    TakeBoneJoints(skin_places_, &file_);
    return std::move(file_);
  }

 private:
  std::string UniqueName(int joint, const std::vector<Joint>& before) const {
    std::string name = GlbNodeName(glb_, skin_.joint_nodes[joint]);
    if (name.empty()) name = absl::StrCat("joint_", skin_.joint_nodes[joint]);
    const std::string stem = name;
    const auto is_taken = [&] {
      return std::ranges::any_of(before, [&](const Joint& other) { return other.name == name; });
    };
    for (int k = 2; is_taken(); ++k) name = absl::StrCat(stem, "_", k);
    return name;
  }

  Eigen::Vector3d RestPosition(int joint) const {
    const Eigen::Matrix4d mesh_from_joint = skin_.inverse_binds.empty()
                                                ? nodes_.world_from_node(skin_.joint_nodes[joint])
                                                : skin_.inverse_binds[joint].inverse();
    return mesh_from_joint.col(3).hnormalized();
  }

  // Returns the joint above several roots. glTF wants a common ancestor of all joints, which gives
  // the name; where that node rests is not in the file, and it often lies on the floor, so the
  // joint is put between the roots.
  Joint CommonRoot(const std::vector<int>& roots) {
    std::vector<int> num_below(static_cast<size_t>(nodes_.count()), 0);
    Joint common{.name = "", .parent = -1, .rest_position = Eigen::Vector3d::Zero()};
    std::string names;
    for (const int root : roots) {
      common.rest_position += RestPosition(root) / static_cast<double>(roots.size());
      absl::StrAppend(&names, names.empty() ? "'" : ", '", UniqueName(root, {}), "'");
      for (int node = nodes_.parent(skin_.joint_nodes[root]); node >= 0;
           node = nodes_.parent(node)) {
        const bool is_common =
            ++num_below[static_cast<size_t>(node)] == static_cast<int>(roots.size());
        if (is_common && common.name.empty()) common.name = GlbNodeName(glb_, node);
      }
    }
    if (common.name.empty()) common.name = "root";
    file_.notes.push_back({.kind = "roots_joined",
                           .text = absl::StrCat("the skin has ", roots.size(), " roots (", names,
                                                "): they are joined under a new joint '",
                                                common.name, "' between them")});
    return common;
  }

  absl::Status MakeSkeleton() {
    parent_joints_ = ParentJoints(skin_, nodes_);
    const std::vector<int> order = ParentsFirst(parent_joints_);
    new_index_.assign(skin_.joint_nodes.size(), -1);
    if (!skin_.inverse_binds.empty()) {
      // Nodes may be posed, so this is only where a mesh in another place or unit may be.
      file_.shown_from_mesh =
          nodes_.world_from_node(skin_.joint_nodes[order[0]]) * skin_.inverse_binds[order[0]];
    }
    std::vector<Joint> joints;
    const auto num_roots = static_cast<size_t>(std::ranges::count(parent_joints_, -1));
    if (num_roots > 1) {
      if (skin_.joint_nodes.size() == kMaxUserJoints) {
        return GlbFault(absl::StrCat("the skin has ", num_roots,
                                     " roots and no room for the joint "
                                     "above them: a rig has at most ",
                                     kMaxUserJoints, " joints"));
      }
      joints.push_back(CommonRoot({order.begin(), order.begin() + num_roots}));
      skin_places_.push_back(-1);
    }
    const int parent_of_roots = static_cast<int>(joints.size()) - 1;
    for (const int j : order) {
      new_index_[j] = static_cast<int>(joints.size());
      const int parent = parent_joints_[j] < 0 ? parent_of_roots : new_index_[parent_joints_[j]];
      joints.push_back({UniqueName(j, joints), parent, RestPosition(j)});
      skin_places_.push_back(j);
    }
    absl::StatusOr<Skeleton> skeleton = Skeleton::Create(std::move(joints));
    if (!skeleton.ok()) return GlbFault(std::string(skeleton.status().message()));
    file_.skeleton = *std::move(skeleton);
    return absl::OkStatus();
  }

  absl::Status ReadMeshes() {
    std::vector<Eigen::Vector3d> positions;
    for (const json& node : glb_.List("nodes")) {
      if (!node.contains("mesh") || node.value("skin", json()) != skin_index_) continue;
      const json& mesh = glb_.Entry("meshes", node["mesh"]);
      const json primitives = mesh.is_object() ? mesh.value("primitives", json()) : json();
      if (!primitives.is_array()) return GlbFault("a mesh has no primitives");
      for (const json& primitive : primitives) {
        PLEAT_RETURN_IF_ERROR(ReadPrimitive(primitive, &positions));
      }
    }
    if (positions.empty()) return GlbFault("no mesh uses the skin");
    file_.positions.resize(3, static_cast<Eigen::Index>(positions.size()));
    for (size_t v = 0; v < positions.size(); ++v) {
      file_.positions.col(static_cast<Eigen::Index>(v)) = positions[v];
    }
    return absl::OkStatus();
  }

  absl::Status ReadPrimitive(const json& primitive, std::vector<Eigen::Vector3d>* positions) {
    const json attributes =
        primitive.is_object() ? primitive.value("attributes", json::object()) : json::object();
    if (!attributes.is_object() || !attributes.contains("POSITION")) {
      return GlbFault("a primitive of the skinned mesh lacks POSITION");
    }
    PLEAT_ASSIGN_OR_RETURN(const GlbAccessor points, glb_.Access(attributes["POSITION"], "VEC3"));
    if (positions->size() + points.count() > static_cast<size_t>(limits_.max_vertices)) {
      return absl::ResourceExhaustedError(
          absl::StrCat("GLB: more than ", limits_.max_vertices, " vertices"));
    }
    for (size_t v = 0; v < points.count(); ++v) {
      const Eigen::Vector3d point(points.At(v, 0), points.At(v, 1), points.At(v, 2));
      if (!point.allFinite()) return GlbFault(absl::StrCat("position ", v, " is not finite"));
      positions->push_back(point);
    }
    PLEAT_ASSIGN_OR_RETURN(
        std::vector<std::vector<JointInfluence>> influences,
        ReadGlbInfluences(glb_, attributes, points.count(), skin_.joint_nodes.size()));
    for (std::vector<JointInfluence>& vertex : influences) {
      for (JointInfluence& influence : vertex) influence.joint = new_index_[influence.joint];
      file_.influences.push_back(std::move(vertex));
    }
    return absl::OkStatus();
  }

  const GlbContainer& glb_;
  const MeshLimits& limits_;
  GlbNodes nodes_;
  size_t skin_index_ = 0;
  GlbSkin skin_;
  std::vector<int> parent_joints_;  // of every joint of the skin, an index in it; -1 = root
  std::vector<int> new_index_;      // the index in file_.skeleton of every joint of the skin
  std::vector<int> skin_places_;    // the index in the skin of every joint of file_.skeleton
  RigFile file_;
};

}  // namespace

absl::StatusOr<RigFile> DecodeRigGlb(std::string_view bytes, const MeshLimits& limits,
                                     std::string_view skin) {
  if (bytes.size() > limits.max_document_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("GLB: ", bytes.size(), " bytes; the limit is ", limits.max_document_bytes));
  }
  PLEAT_ASSIGN_OR_RETURN(const GlbContainer glb, GlbContainer::Open(bytes, limits));
  return SkinReader(glb, limits).Read(skin);
}

}  // namespace pleat
