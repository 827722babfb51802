#include "pleat/rigging/embedding.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "crotch.h"
#include "folded_arms.h"
#include "foot_placement.h"
#include "hand_placement.h"
#include "hidden_legs.h"
#include "main_body.h"
#include "pleat/base/status.h"
#include "pleat/rigging/bone_visibility.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kMinYawChangeDegrees = 10;
// Shares of the template's way from chest to hand: shorter arms may go on, longer ones are
// something else.
constexpr double kWholeArm = .85, kLongestArm = 1.3;
constexpr double kSharedArm = .6;  // share of the way to the end that the search found

// Returns the share of the shell's area that lies farther than `reach` from every bone.
double UncoveredShare(const BodyShell& shell, const Eigen::Matrix3Xd& joints, double reach) {
  double total = 0, uncovered = 0;
  for (int f = 0; f < shell.triangles.cols(); ++f) {
    const Eigen::Vector3d a = shell.positions.col(shell.triangles(0, f));
    const Eigen::Vector3d b = shell.positions.col(shell.triangles(1, f));
    const Eigen::Vector3d c = shell.positions.col(shell.triangles(2, f));
    const double area = (b - a).cross(c - a).norm();
    total += area;
    const NearestBones nearest = FindNearestBones(HumanTemplate(), joints, (a + b + c) / 3);
    if (nearest.distance > reach) uncovered += area;
  }
  return uncovered / total;
}

// Step 8: places all 18 joints, those of degree two at their shares of the paths.
Eigen::Matrix3Xd PlaceAllJoints(const SphereGraph& graph, const SearchTree& tree,
                                const std::vector<int>& spheres) {
  Eigen::Matrix3Xd joints(3, kNumHumanJoints);
  for (size_t j = 0; j < tree.size(); ++j) {
    if (tree[j].parent < 0) {
      joints.col(tree[j].human_joint) = graph.sphere(spheres[j]).center;
      continue;
    }
    Eigen::Matrix3Xd points(3, tree[j].chain.size());
    PlaceOnPath(graph, spheres[tree[j].parent], spheres[j], tree[j].fractions, points);
    for (size_t k = 0; k < tree[j].chain.size(); ++k) {
      joints.col(tree[j].chain[k]) = points.col(k);
    }
  }
  return joints;
}

Eigen::Matrix3Xd TurnedTemplate(double yaw_rad, double body_size) {
  return body_size * (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()).toRotationMatrix() *
                      HumanTemplate().RestPositions());
}

// Turns points of the upright unit box into those of the input.
Eigen::Matrix3Xd WorldFromUpright(const BodyVolume& volume, const Eigen::Matrix3d& upright,
                                  const Eigen::Matrix3Xd& points) {
  return volume.WorldFromUnit(upright.transpose() * points);
}

// One facing of the template and how far its search has come. The members refer to each other (the
// model to the tree, the search to the model), so an object must stay where it is.
struct FacingSearch {
  // `chains` are those of another facing, or null.
  FacingSearch(const MainBody& body, double yaw_degrees, const EmbeddingOptions& options,
               std::shared_ptr<const SearchChains> chains)
      : tree(MakeHumanSearchTree(body.bounds.sizes().maxCoeff(), yaw_degrees / kDegrees)),
        model(body.graph, tree, body.bounds.min().y(), body.bounds.sizes().maxCoeff(),
              options.penalties, std::move(chains)),
        search(model, options.search) {
    facing = {yaw_degrees, 0, true};
  }

  // Searches placements up to `bound`. Only kCancelled is an error.
  absl::Status Deepen(double bound, const Progress& progress) {
    absl::StatusOr<SearchResult> result = search.Run(bound, progress);
    if (absl::IsCancelled(result.status())) return result.status();
    if (result.ok()) {
      found = *std::move(result);
      facing = {facing.yaw_degrees, found->penalty, false};
    } else if (absl::IsNotFound(result.status())) {
      facing.residual = bound;
    } else {
      is_given_up = true;  // too many placements, all of them bad ones
    }
    return absl::OkStatus();
  }
  bool is_open() const { return !found && !is_given_up; }

  SearchTree tree;
  PenaltyModel model;
  EmbeddingSearch search;
  std::optional<SearchResult> found;
  bool is_given_up = false;
  FacingResidual facing;
};

// Deepens all facings together until one of them has a placement. Returns the cheapest, or null
// when there is none below the largest bound. Facings are deepened side by side, not one after the
// other, so that the right one ends the search before a wrong one has been looked at in depth. A
// last round up to `facing_margin` above the best one measures how close the others come.
absl::StatusOr<const FacingSearch*> SearchFacings(
    const EmbeddingOptions& options, const std::vector<std::unique_ptr<FacingSearch>>& searches,
    const Progress& progress) {
  const FacingSearch* best = nullptr;
  const auto deepen_open = [&](double bound) -> absl::Status {
    for (auto& search : searches) {
      if (!search->is_open() || search->facing.residual >= bound) continue;
      PLEAT_RETURN_IF_ERROR(progress.Report(0.5));
      PLEAT_RETURN_IF_ERROR(search->Deepen(bound, progress));
      if (search->found && (!best || search->facing.residual < best->facing.residual)) {
        best = search.get();
      }
    }
    return absl::OkStatus();
  };
  for (double bound = options.search.first_bound; !best; bound *= 2) {
    PLEAT_RETURN_IF_ERROR(deepen_open(std::min(bound, options.search.max_bound)));
    if (bound >= options.search.max_bound) break;
  }
  if (best) {
    PLEAT_RETURN_IF_ERROR(deepen_open(best->facing.residual + options.facing_margin));
  }
  return best;
}

// Moves placed hands to the end of their limb where they lie before it. To the search a bent elbow
// looks like a better end of the arm than a hand that points where the template's does not
// (docs/method/rig.md#arms-and-hands).
std::vector<int> WithWholeArms(const PenaltyModel& model, std::vector<int> spheres) {
  const SphereGraph& graph = model.graph();
  const SearchTree& tree = model.tree();
  const auto path_to = [&](size_t j) { return graph.Path(spheres[tree[j].parent], spheres[j]); };
  for (size_t j = 1; j < tree.size(); ++j) {
    if (tree[j].human_joint != kLeftHand && tree[j].human_joint != kRightHand) continue;
    const int chest = spheres[tree[j].parent];
    const double first_length = graph.PathLength(chest, spheres[j]);
    if (first_length > kWholeArm * tree[j].length) continue;
    std::vector<char> is_taken(graph.size(), 0);
    for (size_t k = 1; k < tree.size(); ++k) {
      if (k == j) continue;
      for (const int i : path_to(k)) is_taken[i] = 1;
    }
    const std::vector<int> first_path = path_to(j);
    double longest = first_length;
    for (const int i : model.candidates(static_cast<int>(j))) {
      const double length = graph.PathLength(chest, i);
      if (!(length > longest) || length > kLongestArm * tree[j].length) continue;
      const std::vector<int> path = graph.Path(chest, i);
      const auto fork = std::ranges::mismatch(path, first_path).in1;  // paths begin alike
      if (graph.PathLength(chest, *(fork - 1)) < kSharedArm * first_length ||
          std::any_of(fork, path.end(), [&](int k) { return is_taken[k] != 0; })) {
        continue;
      }
      longest = length;
      spheres[j] = i;
    }
  }
  return spheres;
}

// Returns where a placement faces by its own left and right feet and hands, in degrees in [0, 360).
double MeasuredYaw(const SphereGraph& graph, const FacingSearch& facing) {
  Eigen::Vector3d right_to_left = Eigen::Vector3d::Zero();
  for (size_t j = 0; j < facing.tree.size(); ++j) {
    const int mirror = facing.tree[j].mirror;
    if (mirror <= static_cast<int>(j)) continue;  // the left one comes first
    right_to_left += graph.sphere(facing.found->spheres[j]).center -
                     graph.sphere(facing.found->spheres[mirror]).center;
  }
  const double yaw = std::atan2(-right_to_left.z(), right_to_left.x()) * kDegrees;
  return yaw < 0 ? yaw + 360 : yaw;
}

// Adds the facing that `best` shows when it differs from the one it was found with, and returns the
// better of the two.
absl::StatusOr<const FacingSearch*> AdjustFacing(
    const MainBody& body, const FacingSearch* best, const EmbeddingOptions& options,
    std::vector<std::unique_ptr<FacingSearch>>* searches, const Progress& progress) {
  const double yaw = MeasuredYaw(body.graph, *best);
  if (std::abs(std::remainder(yaw - best->facing.yaw_degrees, 360)) < kMinYawChangeDegrees) {
    return best;
  }
  searches->push_back(std::make_unique<FacingSearch>(body, yaw, options, best->model.chains()));
  FacingSearch& adjusted = *searches->back();
  PLEAT_RETURN_IF_ERROR(adjusted.Deepen(best->facing.residual, progress));
  return adjusted.found ? &adjusted : best;
}

void KeepPlaced(const std::vector<PlacedJoint>& placed, Eigen::Matrix3Xd* joints) {
  for (const PlacedJoint& joint : placed) joints->col(joint.joint) = joint.position;
}

// Refines the joints, finds what the surface shows of hands, feet and crotch with them, and refines
// the others again. Hidden legs are those of the template.
Eigen::Matrix3Xd RefineTwice(const BodyVolume& volume, const MainBody& body,
                             const Eigen::Matrix3Xd& start, const Eigen::Matrix3Xd& template_joints,
                             bool has_hidden_legs, const EmbeddingOptions& options) {
  RefinementOptions refinement = options.refinement;
  for (const PlacedJoint& placed : options.placed) refinement.held_joints.push_back(placed.joint);
  Eigen::Matrix3Xd joints =
      RefineEmbedding(start, template_joints, body.medial_samples, refinement);
  PlaceHands(body, body.bounds.sizes().maxCoeff(), &joints);
  refinement.held_joints.insert(refinement.held_joints.end(), {kLeftHand, kRightHand});
  if (has_hidden_legs) {
    PlaceHiddenLegs(body, template_joints, &joints);
    refinement.held_joints.push_back(kHips);
    for (int j = kLeftUpperLeg; j <= kRightToes; ++j) refinement.held_joints.push_back(j);
  } else {
    const std::optional<Crotch> crotch =
        FindCrotch(volume.field, options.upright_from_input, joints, body.bounds);
    if (crotch) refinement.hip_height = crotch->hips;
    const std::array<bool, 2> has_foot = PlaceFeet(body, &joints);
    for (int side = 0; side < 2; ++side) {
      if (!has_foot[side]) continue;
      const int ankle = side == 0 ? kLeftFoot : kRightFoot;
      refinement.held_joints.insert(refinement.held_joints.end(), {ankle, ankle + 1});
    }
  }
  KeepPlaced(options.placed, &joints);
  return RefineEmbedding(joints, template_joints, body.medial_samples, refinement);
}

// Adds the facings along the horizontal principal axes of the body where they lie between those
// that are tried anyway: left and right hand are farthest from each other in most poses.
void AddAlignedYaws(const MainBody& body, EmbeddingOptions* options) {
  const double yaw = HorizontalAxisYaw(body.shell, Eigen::Matrix3d::Identity()) * kDegrees;
  for (const double tried : options->yaws_degrees) {
    if (std::abs(std::remainder(yaw - tried, 90)) < kMinYawChangeDegrees) return;
  }
  for (int quarter = 0; quarter < 4; ++quarter) {
    options->yaws_degrees.push_back(std::fmod(yaw + 360 + 90 * quarter, 360));
  }
}

// Lays the template into the bounds of the body, facing where the placed joints fit best.
Eigen::Matrix3Xd TemplateInBounds(const MainBody& body, const EmbeddingOptions& options,
                                  double* yaw_degrees) {
  Eigen::Vector3d floor = body.bounds.center();
  floor.y() = body.bounds.min().y();
  Eigen::Matrix3Xd best;
  double least = std::numeric_limits<double>::infinity();
  for (const double yaw : options.yaws_degrees) {
    const Eigen::Matrix3Xd joints =
        TurnedTemplate(yaw / kDegrees, body.bounds.sizes().y()).colwise() + floor;
    double error = 0;
    for (const PlacedJoint& placed : options.placed) {
      error += (joints.col(placed.joint) - placed.position).squaredNorm();
    }
    if (error >= least) continue;
    least = error;
    best = joints;
    *yaw_degrees = yaw;
  }
  return best;
}

// What the search found: the spheres of the joints of the tree (none where the template was laid
// into the bounds), and all joints at the paths between them, 3 x 18.
struct Placement {
  SearchTree tree;
  std::vector<int> spheres;
  Eigen::Matrix3Xd joints;
};

// Searches the cheapest placement of all facings. Fills the residual, the yaw and the facings of
// `embedding`. kNotFound when there is none and no joint is placed.
absl::StatusOr<Placement> SearchJoints(const MainBody& body, const EmbeddingOptions& options,
                                       Embedding* embedding, const Progress& progress) {
  std::vector<std::unique_ptr<FacingSearch>> searches;
  for (double yaw : options.yaws_degrees) {
    searches.push_back(std::make_unique<FacingSearch>(
        body, yaw, options, searches.empty() ? nullptr : searches[0]->model.chains()));
  }
  PLEAT_ASSIGN_OR_RETURN(const FacingSearch* best, SearchFacings(options, searches, progress));
  if (!best && !options.placed.empty()) {
    embedding->search_residual = options.search.max_bound;
    return Placement{{}, {}, TemplateInBounds(body, options, &embedding->yaw_degrees)};
  }
  if (!best) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& search : searches) least = std::min(least, search->facing.residual);
    return absl::NotFoundError(absl::StrFormat(
        "the human skeleton does not fit this body: its residual is above %.2f in each of the %d "
        "facings tried",
        least, searches.size()));
  }
  if (options.adjust_yaw) {
    PLEAT_ASSIGN_OR_RETURN(best, AdjustFacing(body, best, options, &searches, progress));
  }
  embedding->search_residual = best->facing.residual;
  embedding->yaw_degrees = best->facing.yaw_degrees;
  for (const auto& search : searches) embedding->facings.push_back(search->facing);
  Placement placement{best->tree, WithWholeArms(best->model, best->found->spheres), {}};
  placement.joints = PlaceAllJoints(body.graph, placement.tree, placement.spheres);
  PlaceHands(body, body.bounds.sizes().maxCoeff(), &placement.joints);
  return placement;
}

}  // namespace

Eigen::Matrix3d UprightFromJoints(const Eigen::Matrix3Xd& joints) {
  const Eigen::Vector3d feet = 0.5 * (joints.col(kLeftFoot) + joints.col(kRightFoot));
  const Eigen::Vector3d up = (Eigen::Vector3d(joints.col(kHead)) - feet).normalized();
  Eigen::Vector3d left = joints.col(kLeftUpperLeg) - joints.col(kRightUpperLeg) +
                         joints.col(kLeftUpperArm) - joints.col(kRightUpperArm);
  left = (left - up * up.dot(left)).normalized();
  Eigen::Matrix3d upright;
  upright << left.transpose(), up.transpose(), left.cross(up).transpose();
  return upright;
}

absl::StatusOr<Embedding> EmbedSkeleton(const BodyVolume& volume, const EmbeddingOptions& given,
                                        const Progress& progress) {
  if (given.yaws_degrees.empty()) {
    return absl::InvalidArgumentError("no facing to try for the skeleton");
  }
  EmbeddingOptions options = given;
  const Eigen::Matrix3d& upright = options.upright_from_input;
  for (PlacedJoint& placed : options.placed) {
    placed.position = upright * volume.UnitFromWorld(placed.position);
  }
  options.penalties.placed = options.placed;
  const MainBody body = FindMainBody(volume, upright);
  if (options.adjust_yaw && options.yaws_degrees.size() > 1) AddAlignedYaws(body, &options);
  const double body_size = body.bounds.sizes().maxCoeff();
  Embedding embedding;
  embedding.num_spheres = body.graph.size();
  PLEAT_ASSIGN_OR_RETURN(const Placement placement,
                         SearchJoints(body, options, &embedding, progress));
  Eigen::Matrix3Xd joints = placement.joints;
  KeepPlaced(options.placed, &joints);
  embedding.initial_joints = WorldFromUpright(volume, upright, joints);
  embedding.has_hidden_legs = AreLegsHidden(volume, body, upright);
  joints =
      RefineTwice(volume, body, joints, TurnedTemplate(embedding.yaw_degrees / kDegrees, body_size),
                  embedding.has_hidden_legs, options);
  embedding.arm_shortfall =
      std::max(ArmShortfall(joints, kLeftUpperArm), ArmShortfall(joints, kRightUpperArm));
  embedding.has_short_arm = EndsEarly(joints, kLeftUpperArm) || EndsEarly(joints, kRightUpperArm);
  UnfoldArms(body.graph, placement.tree, placement.spheres, options.placed, &joints);
  embedding.joints = WorldFromUpright(volume, upright, joints);
  embedding.uncovered_share =
      UncoveredShare(body.shell, joints, options.cover_distance * body_size);
  embedding.residual = embedding.search_residual +
                       options.uncovered_weight * std::min(0.25, embedding.uncovered_share);
  if (embedding.has_hidden_legs) {
    embedding.residual = std::max(embedding.residual, options.hidden_legs_residual);
  }
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return embedding;
}

}  // namespace pleat
