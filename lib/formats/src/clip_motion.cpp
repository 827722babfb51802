#include "clip_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/formats/joint_names.h"
#include "pleat/math/rigid.h"
#include "pleat/mesh/bounds.h"

namespace pleat {
namespace {

constexpr size_t kMaxNamed = 40;  // joints of the file in a message
// In diagonals of the skeleton. Joints that rest further off belong to another body or rest pose.
constexpr double kMaxRestDistance = .02;
// Two clips of one body differ by less; more is worth a warning.
constexpr double kMaxStray = .005;

absl::Status ClipFault(const std::string& what) { return absl::InvalidArgumentError(what); }

bool IsAbove(const JointClip& clip, int above, int joint) {
  while (joint >= 0 && joint != above) joint = clip.joints[static_cast<size_t>(joint)].parent;
  return joint == above;
}

// What carries a point of the clip into the world of the skeleton: x -> scale * (turn * x).
struct RestFit {
  double scale = 1;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
};

// The joint that is furthest off when the rest poses lie on each other, and how far (meters).
std::pair<int, double> FurthestJoint(const Eigen::Matrix3Xd& clip, const Eigen::Matrix3Xd& rest,
                                     const RestFit& fit) {
  Eigen::Index furthest = 0;
  const double distance =
      (fit.scale * (fit.turn * clip) - rest).colwise().norm().maxCoeff(&furthest);
  return {static_cast<int>(furthest), distance};
}

absl::StatusOr<RestFit> FitRest(const JointClip& clip, const std::vector<int>& matches,
                                const Skeleton& skeleton, std::vector<std::string>* warnings) {
  Eigen::Matrix3Xd rest = skeleton.RestPositions(), joints(3, rest.cols());
  const Eigen::Matrix3Xd all = clip.RestPositions();
  for (Eigen::Index j = 0; j < rest.cols(); ++j) joints.col(j) = all.col(matches[j]);
  const double diagonal = BoundsDiagonal(rest);
  rest.colwise() -= rest.rowwise().mean().eval();
  joints.colwise() -= joints.rowwise().mean().eval();
  if (!(joints.norm() > 0) || !std::isfinite(joints.norm())) {
    return ClipFault("the joints of the file rest all in one place: its offsets are zero");
  }
  RestFit fit{.scale = rest.norm() / joints.norm()};
  const std::string unit = UnitName(fit.scale, &fit.scale);
  if (FurthestJoint(joints, rest, fit).second > kMaxRestDistance * diagonal) {
    PLEAT_ASSIGN_OR_RETURN(const RigidTransform motion,
                           FitRigidTransform(fit.scale * joints, rest));
    fit.turn = motion.rotation;
    const auto [furthest, distance] = FurthestJoint(joints, rest, fit);
    if (distance > kMaxRestDistance * diagonal) {
      const UnitGuess guess = GuessUnit(clip);
      return ClipFault(absl::StrFormat(
          "the file's skeleton has the character's joints in another rest pose or of another "
          "body: laid on the character, '%s' rests %.3g m away (its longest way from tip to tip is "
          "%.4g, as of a person in %s)",
          EscapeControls(skeleton.joint(furthest).name), distance, guess.size, guess.name));
    }
    const Eigen::AngleAxisd turn(fit.turn);
    warnings->push_back(absl::StrFormat(
        "the file's skeleton is turned by %.1f degrees about (%.2f, %.2f, %.2f): its motion is "
        "turned with it",
        turn.angle() * 180 / std::numbers::pi, turn.axis().x(), turn.axis().y(), turn.axis().z()));
  }
  if (unit.empty()) {
    warnings->push_back(absl::StrFormat(
        "the file's skeleton is scaled by %.4g to the size of the character", fit.scale));
  } else if (fit.scale != 1) {
    warnings->push_back(
        absl::StrCat("lengths are in ", unit, ", judged by the bones of the character"));
  }
  return fit;
}

// Says when the joints of the clip are not where those of the character are: the lengths of its
// bones change, or joints move without a rotation.
class StrayJoints {
 public:
  void Add(const Skeleton& skeleton, const Pose& pose, const Eigen::Matrix3Xd& wanted, size_t t) {
    ComputeBoneTransforms(skeleton, pose, {}, &transforms_);
    Eigen::Index joint = 0;
    const double distance =
        (transforms_.joint_positions - wanted).colwise().norm().maxCoeff(&joint);
    if (!(distance > distance_)) return;
    distance_ = distance;
    joint_ = static_cast<int>(joint);
    frame_ = t;
  }
  void Warn(const Skeleton& skeleton, std::vector<std::string>* warnings) const {
    if (distance_ <= kMaxStray * BoundsDiagonal(skeleton.RestPositions())) return;
    warnings->push_back(absl::StrFormat(
        "bones keep the lengths of the character: '%s' is up to %.3g m from where the file has it "
        "(frame %d)",
        EscapeControls(skeleton.joint(joint_).name), distance_, frame_));
  }

 private:
  BoneTransforms transforms_;
  double distance_ = 0;
  int joint_ = 0;
  size_t frame_ = 0;
};

Pose PoseOfFrame(const JointClip& clip, const std::vector<int>& matches, const Skeleton& skeleton,
                 const RestFit& fit, const PlacedJoints& placed) {
  const Eigen::Quaterniond turn(fit.turn);
  const bool is_turned = !fit.turn.isIdentity(0);
  std::vector<Eigen::Quaterniond> world;  // of each bone
  Pose pose;
  pose.root_position = fit.scale * (fit.turn * placed.positions.col(matches[0]));
  for (int b = 0; b < skeleton.num_joints(); ++b) {
    const int match = matches[static_cast<size_t>(b)];
    const int turning = b == 0 ? match : clip.joints[static_cast<size_t>(match)].parent;
    Eigen::Quaterniond rotation = placed.rotations[static_cast<size_t>(turning)];
    if (is_turned) rotation = turn * rotation * turn.conjugate();
    world.push_back(rotation);
    pose.rotations.push_back(
        (b == 0 ? rotation : world[static_cast<size_t>(skeleton.parent(b))].conjugate() * rotation)
            .normalized());
  }
  return pose;
}

}  // namespace

absl::StatusOr<std::vector<int>> MatchJoints(const JointClip& clip, const Skeleton& skeleton) {
  std::vector<int> matches;
  std::vector<std::string> missing;
  for (const Joint& joint : skeleton.joints()) {
    matches.push_back(clip.FindJoint(joint.name));
    if (matches.back() < 0) missing.push_back(EscapeControls(joint.name));
  }
  if (!missing.empty()) {
    const UnitGuess guess = GuessUnit(clip);
    return ClipFault(absl::StrFormat(
        "the file is of another skeleton: of the character's joints it lacks %s; it has %s (its "
        "longest way from tip to tip is %.4g, as of a person in %s)",
        absl::StrJoin(missing, ", "), ListJointNames(clip.joints, kMaxNamed), guess.size,
        guess.name));
  }
  for (int j = 1; j < skeleton.num_joints(); ++j) {
    const int parent = skeleton.parent(j);
    if (matches[j] != matches[parent] && IsAbove(clip, matches[parent], matches[j])) continue;
    return ClipFault(absl::StrCat(
        "in the file '", EscapeControls(skeleton.joint(j).name), "' does not hang below '",
        EscapeControls(skeleton.joint(parent).name), "', as it does in the character"));
  }
  return matches;
}

absl::StatusOr<Motion> MotionFromClip(const JointClip& clip, const Skeleton& skeleton) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<int> matches, MatchJoints(clip, skeleton));
  Motion motion;
  PLEAT_ASSIGN_OR_RETURN(const RestFit fit, FitRest(clip, matches, skeleton, &motion.warnings));
  PoseTrack::Parts parts{.fps = clip.fps};
  PlacedJoints placed;
  Eigen::Matrix3Xd wanted(3, skeleton.num_joints());
  StrayJoints stray;
  for (size_t t = 0; t < clip.num_frames(); ++t) {
    PlaceJoints(clip, t, &placed);
    Pose pose = PoseOfFrame(clip, matches, skeleton, fit, placed);
    for (size_t j = 0; t > 0 && j < pose.rotations.size(); ++j) {  // no jumps of the sign
      if (pose.rotations[j].dot(parts.poses.back().rotations[j]) < 0) {
        pose.rotations[j].coeffs() *= -1;
      }
    }
    for (Eigen::Index j = 0; j < wanted.cols(); ++j) {
      wanted.col(j) = fit.scale * (fit.turn * placed.positions.col(matches[j]));
    }
    stray.Add(skeleton, pose, wanted, t);
    parts.poses.push_back(std::move(pose));
  }
  stray.Warn(skeleton, &motion.warnings);
  PLEAT_ASSIGN_OR_RETURN(motion.track, PoseTrack::Create(std::move(parts)));
  return motion;
}

}  // namespace pleat
