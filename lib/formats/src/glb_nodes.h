// The nodes of a glTF file: their hierarchy and where each lies in the world.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "glb_container.h"

namespace pleat {

// The place of a node relative to its parent.
struct GlbTransform {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero(), scale = Eigen::Vector3d::Ones();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  std::optional<Eigen::Matrix4d> matrix{};  // in place of the three where the file has one

  Eigen::Matrix4d Matrix() const;
};

// The transforms are those that the file was saved with, which may be any pose of an animation.
class GlbNodes {
 public:
  // kInvalidArgument names a node that has two parents, is its own ancestor or has a bad transform.
  static absl::StatusOr<GlbNodes> Read(const GlbContainer& glb);

  int count() const { return static_cast<int>(parents_.size()); }
  int parent(int node) const { return parents_[static_cast<size_t>(node)]; }  // -1 = none
  const Eigen::Matrix4d& world_from_node(int node) const {
    return world_from_node_[static_cast<size_t>(node)];
  }
  const std::vector<GlbTransform>& transforms() const { return transforms_; }
  // Puts the nodes elsewhere: one transform for each.
  void Pose(const std::vector<GlbTransform>& transforms);
  // The nodes that the file shows, ascending: those of its default scene, or all where it has no
  // scenes.
  const std::vector<int>& shown() const { return shown_; }

 private:
  absl::Status ReadParents(const GlbContainer& glb);
  absl::Status ReadTransforms(const GlbContainer& glb);
  absl::Status FindShown(const GlbContainer& glb);
  // Appends the descendants of the nodes in `list`, parents before children.
  void AppendDescendants(std::vector<int>* list) const;

  std::vector<int> parents_;
  std::vector<std::vector<int>> children_;
  std::vector<int> order_;  // parents before children
  std::vector<GlbTransform> transforms_;
  std::vector<Eigen::Matrix4d> world_from_node_;
  std::vector<int> shown_;
};

}  // namespace pleat
