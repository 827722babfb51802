// Step 7 of the embedding, first half: what makes a placement of the skeleton a bad one.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "pleat/rigging/search_chains.h"
#include "pleat/rigging/search_tree.h"
#include "pleat/rigging/sphere_graph.h"

namespace pleat {

// The weights of the nine penalties (docs/method/rig.md#the-nine-penalties; the kinds are those of
// Baran and Popovic 2007, section 3.3, the formulas are our own). Penalties that sum to more than 1
// forbid a placement.
struct PenaltyWeights {
  double length = .027;           // bone chain shorter than the template's
  double direction = .023;        // against parent and siblings
  double symmetry = .007;         // lengths of mirrored chains
  double shared_path = .046;      // two chains through the same spheres
  double foot_height = .014;      // foot above the lowest vertex
  double same_sphere = .012;      // joint on its parent's sphere
  double local_direction = .072;  // template bones of the chain, laid along the path
  double leaf = .005;             // limb goes on behind a leaf
  double proximity = .033;        // far along the skeleton, near in the body
};

struct PenaltyOptions {
  PenaltyWeights weights;
  int max_deep_candidates = 50;  // deep joints: the largest spheres
  // The template is used at this share of the body's size, so that lengths punish mainly chains
  // that come out short; a chain under half of that is forbidden.
  double template_scale = 0.58;
  // The most that the direction of a forearm may cost (10 in the opposite direction). Elbows bend
  // far, but most rest poses hang or spread the arms.
  double most_forearm_mismatch = std::numeric_limits<double>::infinity();
  // Joints of the search tree among these may lie on the few spheres next to their place alone.
  std::vector<PlacedJoint> placed = {};
};

// The joints placed so far, as the next joint sees them.
struct PlacementContext {
  struct Other {  // a joint placed before, not the parent
    int sphere;
    double length_to_parent;  // along the embedded skeleton, to the next joint's parent
    bool is_sibling;
    Eigen::Vector3d template_offset;  // from it to the next joint
  };
  int joint = 0;
  int parent_sphere = -1;
  double mirror_length = 0;  // length of the mirrored chain, 0 = not placed
  std::vector<Other> others;
  std::vector<char> is_used;  // per sphere: on the path of a chain placed before
};

// The costs of placing the joints of `tree` on the spheres of `graph`, one joint after the other.
// All costs are >= 0, which the search's bound relies on; infinite = forbidden. The graph and the
// tree must outlive this object.
class PenaltyModel {
 public:
  // floor_height and body_size: the lowest vertex and the longest side of the body, unit box.
  // `chains` are those of the graph and the tree at any facing; null: made here.
  PenaltyModel(const SphereGraph& graph, const SearchTree& tree, double floor_height,
               double body_size, const PenaltyOptions& options = {},
               std::shared_ptr<const SearchChains> chains = nullptr);

  const SphereGraph& graph() const { return graph_; }
  const SearchTree& tree() const { return tree_; }
  const std::shared_ptr<const SearchChains>& chains() const { return chains_; }
  // The spheres that may hold joint j.
  const std::vector<int>& candidates(int j) const { return chains_->candidates(j); }

  // Returns what joint j > 0 on its candidate c costs when its parent lies on the parent's
  // candidate p; where that is more than `cap`, some number above `cap` that is not more than it.
  double PairPenalty(int j, size_t c, size_t p,
                     double cap = std::numeric_limits<double>::infinity()) const;
  // Returns what joint j is compared with when joints 0..j-1 lie on spheres[0..j-1].
  PlacementContext MakeContext(int j, const std::vector<int>& spheres) const;
  // Returns what the joint of `context` on `sphere` costs against the joints placed before it; what
  // it costs against its parent is in PairPenalty. Its parent must reach `sphere`.
  double ContextPenalty(const PlacementContext& context, int sphere) const;

 private:
  double LocalDirection(int j, size_t c, size_t p) const;
  double LeafPenalty(int sphere, int parent_sphere) const;

  const SphereGraph& graph_;
  const SearchTree& tree_;
  double floor_height_, body_size_;
  PenaltyOptions options_;
  std::shared_ptr<const SearchChains> chains_;
};

}  // namespace pleat
