// Gleicher, Retargetting Motion to New Characters, SIGGRAPH 1998, names the problem. The
// constraints that it solves for are here those of the feet alone, which clean_feet.h holds.
#include "pleat/motion/retarget.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "pleat/base/status.h"
#include "pleat/motion/clean_feet.h"
#include "pleat/motion/default_joint_map.h"
#include "pleat/motion/leg_joints.h"
#include "pleat/skeleton/pose.h"
#include "rest_alignment.h"

namespace pleat {
namespace {

constexpr size_t kUpFrames = 200;  // that are looked at for the axis that points up

// Which axis the trunk of the clip points along: at rest, or on average while it moves.
ClipUp FindUp(const JointClip& clip, const std::vector<ResolvedBone>& bones,
              const Landmarks& target) {
  int top = -1;
  for (const ResolvedBone& bone : bones) {
    if (bone.bone == target[kHead] || (top < 0 && bone.bone == target[kChest])) top = bone.turns;
  }
  if (top < 0) return ClipUp::kY;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const size_t step = std::max<size_t>(1, clip.num_frames() / kUpFrames);
  PlacedJoints placed;
  for (size_t t = 0; t < clip.num_frames(); t += step) {
    PlaceJoints(clip, t, &placed);
    sum += (placed.positions.col(top) - placed.positions.col(bones[0].from)).normalized();
  }
  return sum.z() > std::abs(sum.y()) ? ClipUp::kZ : ClipUp::kY;
}

// Turns the world of a clip whose Z points up.
void TurnUp(JointClip* clip) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-EIGEN_PI / 2, Eigen::Vector3d::UnitX()));
  for (ClipJoint& joint : clip->joints) joint.offset = turn * joint.offset;
  for (Eigen::Vector3d& translation : clip->translations) translation = turn * translation;
  for (Eigen::Quaterniond& rotation : clip->rotations) {
    rotation = turn * rotation * turn.conjugate();
  }
}

class Retargeter {
 public:
  Retargeter(const JointClip& clip, const Skeleton& skeleton, std::vector<ResolvedBone> bones,
             const LegJoints& legs, RetargetReport* report)
      : clip_(clip), skeleton_(skeleton), bones_(std::move(bones)), legs_(legs), report_(report) {
    from_of_.assign(static_cast<size_t>(skeleton.num_joints()), -1);
    for (const ResolvedBone& bone : bones_) from_of_[static_cast<size_t>(bone.bone)] = bone.from;
  }

  absl::Status FindScale(const std::optional<double>& given) {
    const Eigen::Matrix3Xd rest = clip_.RestPositions();
    double clip_length = 0;
    for (const LegJoints::Leg& leg : legs_.legs) {
      const int hip = From(leg.hip), knee = From(leg.knee), ankle = From(leg.ankle);
      if (hip < 0 || knee < 0 || ankle < 0) {
        return absl::InvalidArgumentError(
            "the joint map must drive hips, both legs and both feet of the character");
      }
      clip_length += (rest.col(knee) - rest.col(hip)).norm();
      clip_length += (rest.col(ankle) - rest.col(knee)).norm();
    }
    report_->leg_length_m = legs_.MeanLength(skeleton_);
    if (!(clip_length > 0) || !std::isfinite(clip_length)) {
      return absl::InvalidArgumentError("the legs of the clip have no length at rest");
    }
    report_->scale = given.value_or(2 * report_->leg_length_m / clip_length);
    return absl::OkStatus();
  }

  // The ways of the clip's feet, scaled to the character.
  std::array<FootPath, 2> ClipFeet() const {
    std::array<FootPath, 2> paths;
    const auto num_frames = static_cast<Eigen::Index>(clip_.num_frames());
    for (FootPath& path : paths) {
      path.ankle.resize(3, num_frames);
      path.toes.resize(3, num_frames);
    }
    PlacedJoints placed;
    for (Eigen::Index t = 0; t < num_frames; ++t) {
      PlaceJoints(clip_, static_cast<size_t>(t), &placed);
      for (size_t side = 0; side < 2; ++side) {
        const int ankle = From(legs_.legs[side].ankle), toes = From(legs_.legs[side].toes);
        paths[side].ankle.col(t) = report_->scale * placed.positions.col(ankle);
        paths[side].toes.col(t) = report_->scale * placed.positions.col(toes < 0 ? ankle : toes);
      }
    }
    return paths;
  }

  PoseTrack::Parts Drive(const Landmarks& target) {
    RestAlignment rest = AlignRests({clip_, skeleton_, bones_, target, report_->contacts});
    report_->rest_stands = rest.stands;
    std::ranges::move(rest.warnings, std::back_inserter(report_->warnings));
    PoseTrack::Parts parts{.fps = clip_.fps};
    PlacedJoints placed;
    for (size_t t = 0; t < clip_.num_frames(); ++t) {
      PlaceJoints(clip_, t, &placed);
      Pose pose = PoseOf(placed, rest.turns);
      for (size_t j = 0; t > 0 && j < pose.rotations.size(); ++j) {  // no jumps of the sign
        if (pose.rotations[j].dot(parts.poses.back().rotations[j]) < 0) {
          pose.rotations[j].coeffs() *= -1;
        }
      }
      parts.poses.push_back(std::move(pose));
    }
    return parts;
  }

 private:
  int From(int joint) const { return joint < 0 ? -1 : from_of_[static_cast<size_t>(joint)]; }

  Pose PoseOf(const PlacedJoints& placed, const std::vector<Eigen::Matrix3d>& turns) {
    std::vector<Eigen::Matrix3d> world(static_cast<size_t>(skeleton_.num_joints()));
    Pose pose = Pose::Rest(skeleton_);
    size_t next = 0;
    for (int b = 0; b < skeleton_.num_joints(); ++b) {
      Eigen::Matrix3d& rotation = world[static_cast<size_t>(b)];
      const int parent = skeleton_.parent(b);
      if (parent >= 0) rotation = world[static_cast<size_t>(parent)];
      if (next < bones_.size() && bones_[next].bone == b) {
        rotation = WorldOf(bones_[next], placed, turns[next]);
        ++next;
      }
      Eigen::Matrix3d local = rotation;
      if (parent >= 0) local = world[static_cast<size_t>(parent)].transpose() * rotation;
      pose.rotations[static_cast<size_t>(b)] = Eigen::Quaterniond(local).normalized();
    }
    PlaceRoot(placed, &pose);
    return pose;
  }

  Eigen::Matrix3d WorldOf(const ResolvedBone& bone, const PlacedJoints& placed,
                          const Eigen::Matrix3d& turn) const {
    const Eigen::Matrix3d rotation =
        placed.rotations[static_cast<size_t>(bone.turns)].toRotationMatrix() * turn;
    if (bone.alignment != BoneAlignment::kDirection || bone.bone == 0) return rotation;
    // Where several joints of the clip are one bone, only their ends say where it points.
    const Eigen::Vector3d has = rotation * (skeleton_.rest_position(bone.bone) -
                                            skeleton_.rest_position(skeleton_.parent(bone.bone)));
    const Eigen::Vector3d wanted =
        placed.positions.col(bone.from) - placed.positions.col(bone.begin);
    return ShortestTurn(has, wanted) * rotation;
  }

  // The middle of the two hip joints goes the way of that of the clip, so that ankles of legs that
  // are as long end where those of the clip are.
  void PlaceRoot(const PlacedJoints& placed, Pose* pose) {
    pose->root_position.setZero();
    ComputeBoneTransforms(skeleton_, *pose, {}, &transforms_);
    Eigen::Vector3d wanted = Eigen::Vector3d::Zero(), has = wanted;
    for (const LegJoints::Leg& leg : legs_.legs) {
      wanted += .5 * report_->scale * placed.positions.col(From(leg.hip));
      has += .5 * transforms_.joint_positions.col(leg.hip);
    }
    pose->root_position = wanted - has;
  }

  const JointClip& clip_;
  const Skeleton& skeleton_;
  const std::vector<ResolvedBone> bones_;
  const LegJoints& legs_;
  RetargetReport* report_;
  std::vector<int> from_of_;  // J
  BoneTransforms transforms_;
};

}  // namespace

absl::StatusOr<PoseTrack> Retarget(const JointClip& clip, const JointMap& map,
                                   const Skeleton& skeleton, const RetargetOptions& options,
                                   RetargetReport* report) {
  *report = RetargetReport{};
  const Landmarks target = FindLandmarks(BodyJointsOf(skeleton));
  PLEAT_ASSIGN_OR_RETURN(const LegJoints legs, FindLegJoints(skeleton));
  PLEAT_ASSIGN_OR_RETURN(std::vector<ResolvedBone> bones, ResolveJointMap(map, clip, skeleton));
  if (clip.num_frames() == 0) return absl::InvalidArgumentError("the clip has no frames");
  report->up = map.up == ClipUp::kAuto ? FindUp(clip, bones, target) : map.up;
  JointClip upright;
  const JointClip* used = &clip;
  if (report->up == ClipUp::kZ) {
    upright = clip;
    TurnUp(&upright);
    used = &upright;
  }
  report->unit = GuessUnit(clip);
  Retargeter retargeter(*used, skeleton, std::move(bones), legs, report);
  PLEAT_RETURN_IF_ERROR(retargeter.FindScale(map.scale));
  const std::array<FootPath, 2> clip_feet = retargeter.ClipFeet();
  for (size_t side = 0; side < 2; ++side) {
    report->contacts[side] = DetectContacts(clip_feet[side], clip.fps);
  }
  PoseTrack::Parts parts = retargeter.Drive(target);
  std::array<FootPath, 2> feet = FootPaths(skeleton, legs, parts.poses);
  if (options.on_floor) {
    report->ground_shift_m = -HeightOfFeet(legs, skeleton, feet, report->contacts);
    for (Pose& pose : parts.poses) pose.root_position.y() += report->ground_shift_m;
  }
  report->clip_sliding = MeasureSliding(clip_feet, report->contacts);
  report->sliding = MeasureSliding(feet, report->contacts);
  return PoseTrack::Create(std::move(parts));
}

}  // namespace pleat
