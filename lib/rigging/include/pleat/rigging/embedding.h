// Places the 18-joint human skeleton inside a body.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/rigging/body_volume.h"
#include "pleat/rigging/embedding_search.h"
#include "pleat/rigging/refinement.h"

namespace pleat {

struct EmbeddingOptions {
  // The rotation that turns the mesh so that the character would stand along +y; the identity for
  // most inputs.
  Eigen::Matrix3d upright_from_input = Eigen::Matrix3d::Identity();
  // The facings to try, in degrees about +y from +z towards +x. A wrong one costs milliseconds.
  std::vector<double> yaws_degrees = {0, 90, 180, 270};
  // Whether to try, once the best of them is known, also the facing that its own left and right
  // feet and hands show: characters that stand across the four.
  bool adjust_yaw = true;
  PenaltyOptions penalties;
  SearchOptions search;
  // Facings that cost up to this much more than the best one are still measured.
  double facing_margin = .01;
  // Surface farther from every bone than this share of the body's size is not explained by the
  // skeleton (the hind part of a horse). Its share of the surface, up to a quarter, times the
  // weight is added to the residual.
  double cover_distance = .2;
  double uncovered_weight = .2;
  // The least residual of a body whose legs are hidden: nothing shows where it faces.
  double hidden_legs_residual = .03;
  RefinementOptions refinement;
  // Joints that a person placed, in the units of the mesh: they stay where they are, and the others
  // are found with them. With at least one of them there is always an embedding: where the search
  // finds none, the template is laid into the bounds of the body.
  std::vector<PlacedJoint> placed = {};
};

// The cost of one facing. The search of a facing stops once it is certain that another one is
// better: its residual is then at least this.
struct FacingResidual {
  double yaw_degrees = 0;
  double residual = 0;
  bool is_lower_bound = false;
};

struct Embedding {
  Eigen::Matrix3Xd joints;          // 3 x 18, template order, in the units of the mesh
  Eigen::Matrix3Xd initial_joints;  // the same before the continuous refinement
  double residual = 0;              // search + uncovered surface; .03-.10 is doubtful, .15 no human
  double search_residual = 0;       // penalties alone
  double uncovered_share = 0;       // share of the body's surface, 0..1
  // How much the shorter arm falls short of half a leg, as a share of the leg: an arm that is
  // folded against the body or reaches into the clothes seems to end at the elbow. 0 = none does.
  double arm_shortfall = 0;
  // An arm falls clearly short of that, or of .8 of the trunk. Its forearm was sought against the
  // body.
  bool has_short_arm = false;
  bool has_hidden_legs = false;         // a robe reaches to the floor: the legs are the template's
  double yaw_degrees = 0;               // where the character faces, seen upright
  std::vector<FacingResidual> facings;  // every facing tried, in the order given
  int num_spheres = 0;
};

// Returns the rotation that stands a placed skeleton upright: its own axis from the feet to the
// head along +y, its own left along +x. joints: 3 x 18, template order.
Eigen::Matrix3d UprightFromJoints(const Eigen::Matrix3Xd& joints);

// Runs the whole embedding of Baran and Popovic 2007, "Automatic rigging and animation of 3D
// characters": sphere packing, graph, search over the facings, refinement. The error is kNotFound
// when the skeleton fits in no facing, kInvalidArgument when no facing is given, and kCancelled.
// See docs/method/rig.md#embedding-search.
absl::StatusOr<Embedding> EmbedSkeleton(const BodyVolume& volume,
                                        const EmbeddingOptions& options = {},
                                        const Progress& progress = {});

}  // namespace pleat
