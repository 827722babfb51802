// The nodes of a glTF file: their hierarchy and where each lies in the world.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "glb_container.h"

namespace pleat {

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
  // The nodes that the file shows, ascending: those of its default scene, or all where it has no
  // scenes.
  const std::vector<int>& shown() const { return shown_; }

 private:
  absl::Status ReadParents(const GlbContainer& glb);
  absl::Status PlaceInWorld(const GlbContainer& glb);
  absl::Status FindShown(const GlbContainer& glb);
  // Appends the descendants of the nodes in `list`, parents before children.
  void AppendDescendants(std::vector<int>* list) const;

  std::vector<int> parents_;
  std::vector<std::vector<int>> children_;
  std::vector<Eigen::Matrix4d> world_from_node_;
  std::vector<int> shown_;
};

}  // namespace pleat
