// Khronos, glTF 2.0 specification, sections 3.5.2 (node hierarchy) and 3.5.3 (transformations).
#include "glb_nodes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

absl::Status NodeFault(size_t node, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("GLB: node ", node, what));
}

// Reads a list of `count` finite numbers. Without the key the values stay as they are.
bool ReadNodeNumbers(const json& node, const char* key, size_t count, double* values) {
  const auto found = node.find(key);
  if (found == node.end()) return true;
  if (!found->is_array() || found->size() != count) return false;
  for (size_t k = 0; k < count; ++k) {
    if (!(*found)[k].is_number()) return false;
    values[k] = (*found)[k].get<double>();
    if (!std::isfinite(values[k])) return false;
  }
  return true;
}

// Returns the transform of one node relative to its parent.
absl::StatusOr<GlbTransform> ReadTransform(const json& node, size_t index) {
  GlbTransform transform;
  if (node.contains("matrix")) {
    if (!ReadNodeNumbers(node, "matrix", 16, transform.matrix.emplace().data())) {
      return NodeFault(index, "'s matrix is not 16 numbers");
    }
    return transform;
  }
  Eigen::Vector4d turn(0, 0, 0, 1);  // x, y, z, w
  if (!ReadNodeNumbers(node, "translation", 3, transform.translation.data()) ||
      !ReadNodeNumbers(node, "scale", 3, transform.scale.data()) ||
      !ReadNodeNumbers(node, "rotation", 4, turn.data())) {
    return NodeFault(index, "'s translation, rotation or scale is not a list of finite numbers");
  }
  transform.rotation = Eigen::Quaterniond(turn);
  if (!(transform.rotation.norm() > 0)) return NodeFault(index, "'s rotation is zero");
  transform.rotation.normalize();
  return transform;
}

}  // namespace

Eigen::Matrix4d GlbTransform::Matrix() const {
  if (matrix) return *matrix;
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  transform.translate(translation);
  transform.rotate(rotation);
  transform.scale(scale);
  return transform.matrix();
}

absl::StatusOr<GlbNodes> GlbNodes::Read(const GlbContainer& glb) {
  GlbNodes nodes;
  PLEAT_RETURN_IF_ERROR(nodes.ReadParents(glb));
  PLEAT_RETURN_IF_ERROR(nodes.ReadTransforms(glb));
  PLEAT_RETURN_IF_ERROR(nodes.FindShown(glb));
  return nodes;
}

absl::Status GlbNodes::ReadParents(const GlbContainer& glb) {
  const json& list = glb.List("nodes");
  parents_.assign(list.size(), -1);
  children_.resize(list.size());
  for (size_t n = 0; n < list.size(); ++n) {
    if (!list[n].is_object()) return NodeFault(n, " is not an object");
    const auto children = list[n].find("children");
    if (children == list[n].end()) continue;
    if (!children->is_array()) return NodeFault(n, ": bad children");
    for (const json& child : *children) {
      if (!child.is_number_integer() || child < 0 || child >= list.size() ||
          parents_[child.get<size_t>()] >= 0) {
        return NodeFault(n, ": a child is out of range or has two parents");
      }
      parents_[child.get<size_t>()] = static_cast<int>(n);
      children_[n].push_back(child.get<int>());
    }
  }
  return absl::OkStatus();
}

void GlbNodes::AppendDescendants(std::vector<int>* list) const {
  for (size_t i = 0; i < list->size(); ++i) {
    const std::vector<int>& children = children_[static_cast<size_t>((*list)[i])];
    list->insert(list->end(), children.begin(), children.end());
  }
}

absl::Status GlbNodes::ReadTransforms(const GlbContainer& glb) {
  std::vector<int>& order = order_;
  for (int n = 0; n < count(); ++n) {
    if (parents_[static_cast<size_t>(n)] < 0) order.push_back(n);
  }
  AppendDescendants(&order);
  // Every node has at most one parent, so those that no root leads to are on a cycle or below one.
  if (order.size() < parents_.size()) {
    std::vector<bool> is_placed(parents_.size());
    for (const int n : order) is_placed[static_cast<size_t>(n)] = true;
    const auto first = std::find(is_placed.begin(), is_placed.end(), false);
    return NodeFault(static_cast<size_t>(first - is_placed.begin()),
                     " is its own ancestor, or below a node that is");
  }
  for (size_t n = 0; n < parents_.size(); ++n) {
    PLEAT_ASSIGN_OR_RETURN(GlbTransform transform, ReadTransform(glb.List("nodes")[n], n));
    transforms_.push_back(transform);
  }
  world_from_node_.resize(parents_.size());
  Pose(transforms_);
  return absl::OkStatus();
}

void GlbNodes::Pose(const std::vector<GlbTransform>& transforms) {
  for (const int n : order_) {
    const auto index = static_cast<size_t>(n);
    world_from_node_[index] = transforms[index].Matrix();
    if (parents_[index] >= 0) {
      world_from_node_[index] = world_from_node(parents_[index]) * world_from_node_[index];
    }
  }
}

absl::Status GlbNodes::FindShown(const GlbContainer& glb) {
  if (glb.List("scenes").empty()) {
    for (int n = 0; n < count(); ++n) shown_.push_back(n);
    return absl::OkStatus();
  }
  const json& chosen = glb.Member("scene");
  const json& scene = glb.Entry("scenes", chosen.is_null() ? json(0) : chosen);
  if (!scene.is_object()) return absl::InvalidArgumentError("GLB: the default scene is missing");
  const json roots = scene.value("nodes", json::array());
  std::vector<bool> is_root(parents_.size());
  for (const json& root : roots) {
    if (!root.is_number_integer() || root < 0 || root >= parents_.size() ||
        parents_[root.get<size_t>()] >= 0 || is_root[root.get<size_t>()]) {
      return absl::InvalidArgumentError("GLB: a node of the scene is none, no root or there twice");
    }
    is_root[root.get<size_t>()] = true;
    shown_.push_back(root.get<int>());
  }
  AppendDescendants(&shown_);
  std::sort(shown_.begin(), shown_.end());
  return absl::OkStatus();
}

}  // namespace pleat
