// Where the joints of the search may lie, and the ways between these places. Neither depends on the
// facing, so that all facings share them.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "pleat/rigging/search_tree.h"
#include "pleat/rigging/sphere_graph.h"

namespace pleat {

// A joint whose place is known.
struct PlacedJoint {
  int joint = 0;  // HumanJoint
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

// Immutable.
class SearchChains {
 public:
  // Deep joints may lie on the `max_deep_candidates` largest spheres, leaves where the shape ends,
  // and joints among `placed` on the few spheres next to their place alone. Of `tree`, what turns
  // with the facing is not used.
  SearchChains(const SphereGraph& graph, const SearchTree& tree, int max_deep_candidates,
               const std::vector<PlacedJoint>& placed);

  // The spheres that may hold joint j.
  const std::vector<int>& candidates(int j) const { return candidates_[j]; }
  // Returns where the joints of the chain of j > 0 lie, 3 x chain, on the shortest path from
  // candidate p of its parent to its candidate c.
  auto points(int j, size_t c, size_t p) const {
    const Chain& chain = *chains_[j];
    return chain.points.middleCols(
        static_cast<Eigen::Index>((c + p * candidates_[j].size()) * chain.num_joints),
        static_cast<Eigen::Index>(chain.num_joints));
  }

 private:
  struct Chain {
    size_t num_joints = 0;
    Eigen::Matrix3Xd points;  // chain by chain, candidates of j fastest
  };

  std::vector<std::vector<int>> candidates_;
  std::vector<std::shared_ptr<const Chain>> chains_;  // mirrored joints share theirs
};

// Puts the points at the given fractions, ascending, of the shortest path between two spheres into
// the columns of `points`.
void PlaceOnPath(const SphereGraph& graph, int from, int to, const std::vector<double>& fractions,
                 Eigen::Ref<Eigen::Matrix3Xd> points);

}  // namespace pleat
