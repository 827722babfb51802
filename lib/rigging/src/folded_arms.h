// Arms that seem to end at the elbow, because the forearm lies against the body: crossed before the
// chest, folded, on the hips, behind the back.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "pleat/rigging/search_chains.h"
#include "pleat/rigging/search_tree.h"
#include "pleat/rigging/sphere_graph.h"

namespace pleat {

// Returns how much the arm that begins in the joint `shoulder` falls short of half a leg, as a
// share of the leg: 0 for an arm that is seen up to its wrist. joints: 3 x 18.
double ArmShortfall(const Eigen::Matrix3Xd& joints, int shoulder);

// Returns true when the arm falls clearly short of half a leg, or of .8 of the trunk, which counts
// on short legs.
bool EndsEarly(const Eigen::Matrix3Xd& joints, int shoulder);

struct FoldedArm {
  Eigen::Vector3d elbow, hand;
};

// Follows the forearm from the elbow, on which the search put the hand: through spheres that are
// as thin as an arm and that no chain runs through, straight, and about as far as the upper arm is
// long. radius: of the arm at the elbow; is_taken: per sphere of the graph. None when there is no
// such way.
std::optional<FoldedArm> FollowForearm(const SphereGraph& graph, int elbow, double radius,
                                       const std::vector<char>& is_taken,
                                       const Eigen::Vector3d& shoulder);

// Moves the elbows of arms that end early to their ends, and the hands on along the forearms, where
// these can be followed. `spheres` are those of the joints of `tree`; joints that are among
// `placed` stay. joints: 3 x 18.
void UnfoldArms(const SphereGraph& graph, const SearchTree& tree, const std::vector<int>& spheres,
                const std::vector<PlacedJoint>& placed, Eigen::Matrix3Xd* joints);

}  // namespace pleat
