#include "pleat/motion/default_joint_map.h"

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/formats/joint_names.h"

namespace pleat {
namespace {

constexpr size_t kMaxNamed = 60;  // joints in a message

absl::Status RetargetFault(const std::string& what) { return absl::InvalidArgumentError(what); }

// What each skeleton must have, since the size and the place of the body come from it.
absl::Status CheckLegs(const Landmarks& landmarks, const std::vector<BodyJoint>& joints,
                       const std::string& whose) {
  if (landmarks.HasLegs()) return absl::OkStatus();
  std::vector<std::string> missing;
  for (const HumanJoint joint : {kLeftUpperLeg, kLeftLowerLeg, kLeftFoot, kRightUpperLeg,
                                 kRightLowerLeg, kRightFoot, kHips}) {
    if (landmarks[joint] < 0) missing.push_back(HumanTemplate().joint(joint).name);
  }
  return RetargetFault(
      absl::StrCat(whose, " has no joints that are known as ", absl::StrJoin(missing, ", "),
                   "; it has ", ListJointNames(joints, kMaxNamed),
                   ": write a map with 'pleat motion map', edit it, and give it by --map"));
}

bool HasTemplateNames(const Landmarks& landmarks, const std::vector<BodyJoint>& joints) {
  for (int k = 0; k < kNumHumanJoints; ++k) {
    const int joint = landmarks.joints[static_cast<size_t>(k)];
    if (joint < 0 || joints[static_cast<size_t>(joint)].name != HumanTemplate().joint(k).name) {
      return false;
    }
  }
  return true;
}

int FindBodyJoint(const std::vector<BodyJoint>& joints, const std::string& name) {
  for (size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].name == name) return static_cast<int>(j);
  }
  return -1;
}

class MapMaker {
 public:
  MapMaker(const std::vector<BodyJoint>& source, const Landmarks& landmarks)
      : source_(source), landmarks_(landmarks), bone_names_(HasTemplateNames(landmarks, source)) {}

  JointMapEntry Entry(int landmark) const {
    const int from = FromOf(landmark);
    if (from < 0) return {};
    const int turns = TurnsOf(landmark, from);
    return {.joint = "",
            .from = source_[static_cast<size_t>(from)].name,
            .turns_with = source_[static_cast<size_t>(turns)].name,
            .alignment = AlignmentOf(landmark)};
  }

 private:
  static BoneAlignment AlignmentOf(int landmark) {
    switch (landmark) {
      case kLeftLowerLeg:
      case kRightLowerLeg:
      case kLeftFoot:
      case kRightFoot:
      case kLeftLowerArm:
      case kRightLowerArm:
      case kLeftHand:
      case kRightHand:
        return BoneAlignment::kDirection;
      case kLeftToes:
      case kRightToes:
        return BoneAlignment::kSole;
      default:
        return BoneAlignment::kRotation;
    }
  }

  int ParentOf(int joint) const { return source_[static_cast<size_t>(joint)].parent; }

  // The next joint from `above` down to `below` that rests in another place than `above`.
  int Below(int above, int below) const {
    int next = -1;
    for (int j = below; j >= 0 && j != above; j = ParentOf(j)) {
      const Eigen::Vector3d step = source_[static_cast<size_t>(j)].rest_position -
                                   source_[static_cast<size_t>(above)].rest_position;
      if (step.norm() > 1e-9) next = j;
    }
    return next >= 0 ? next : below;
  }

  // The tip of the head, or of the joint with most joints below.
  int TipOf(int joint) const {
    for (size_t j = 0; j < source_.size(); ++j) {
      if (source_[j].parent == joint && source_[j].is_end) return static_cast<int>(j);
    }
    return joint;
  }

  // In a skeleton with the names of the template a bone ends in the joint of its name. In others,
  // joints of the trunk turn what is above them, so bones of the trunk end one joint further up.
  int FromOf(int landmark) const {
    const int own = landmarks_.joints[static_cast<size_t>(landmark)];
    if (own < 0 || bone_names_) return own;
    const int chest = landmarks_[kChest], head = landmarks_[kHead];
    if (landmark == kSpine && chest >= 0) return Below(own, chest);
    if (landmark == kChest && head >= 0) return Below(own, head);
    if (landmark == kHead) return TipOf(own);
    return own;
  }

  int TurnsOf(int landmark, int from) const {
    const int own = landmarks_.joints[static_cast<size_t>(landmark)];
    if (landmark == kHips) return own;
    if (!bone_names_) {
      if (landmark == kSpine || landmark == kChest || landmark == kHead) return own;
      // The joints between the hips and the thighs of some skeletons do not turn.
      if (landmark == kLeftUpperLeg || landmark == kRightUpperLeg) return landmarks_[kHips];
    }
    const int parent = ParentOf(from);
    return parent >= 0 ? parent : from;
  }

  const std::vector<BodyJoint>& source_;
  const Landmarks& landmarks_;
  const bool bone_names_;
};

}  // namespace

absl::StatusOr<JointMap> MakeJointMap(const JointClip& clip, const Skeleton& skeleton) {
  const std::vector<BodyJoint> source = BodyJointsOf(clip), target = BodyJointsOf(skeleton);
  const Landmarks from = FindLandmarks(source), to = FindLandmarks(target);
  PLEAT_RETURN_IF_ERROR(CheckLegs(from, source, "the clip"));
  PLEAT_RETURN_IF_ERROR(CheckLegs(to, target, "the character"));
  const MapMaker maker(source, from);
  JointMap map;
  std::vector<bool> used(source.size(), false);
  const auto use = [&](const std::string& name) {
    const int joint = FindBodyJoint(source, name);
    if (joint >= 0) used[static_cast<size_t>(joint)] = true;
  };
  for (int j = 0; j < skeleton.num_joints(); ++j) {
    JointMapEntry entry;
    for (int k = 0; k < kNumHumanJoints; ++k) {
      if (to.joints[static_cast<size_t>(k)] == j) entry = maker.Entry(k);
    }
    entry.joint = skeleton.joint(j).name;
    use(entry.from);
    use(entry.turns_with);
    map.joints.push_back(std::move(entry));
  }
  for (size_t j = 0; j < source.size(); ++j) {
    if (!used[j] && !source[j].is_end) map.left_out.push_back(source[j].name);
  }
  return map;
}

absl::StatusOr<std::vector<ResolvedBone>> ResolveJointMap(const JointMap& map,
                                                          const JointClip& clip,
                                                          const Skeleton& skeleton) {
  const std::vector<BodyJoint> source = BodyJointsOf(clip);
  std::vector<ResolvedBone> bones;
  std::vector<int> from_of(static_cast<size_t>(skeleton.num_joints()), -1);
  for (const JointMapEntry& entry : map.joints) {
    if (entry.from.empty()) continue;
    ResolvedBone bone{.bone = skeleton.FindJoint(entry.joint), .alignment = entry.alignment};
    if (bone.bone < 0) {
      return RetargetFault(absl::StrCat("joint map: the character has no joint '",
                                        EscapeControls(entry.joint), "'; it has ",
                                        ListJointNames(BodyJointsOf(skeleton), kMaxNamed)));
    }
    bone.from = FindBodyJoint(source, entry.from);
    const std::string& turns_with = entry.turns_with.empty() ? entry.from : entry.turns_with;
    bone.turns = FindBodyJoint(source, turns_with);
    if (entry.turns_with.empty() && bone.bone > 0 && bone.from >= 0) {
      const int parent = source[static_cast<size_t>(bone.from)].parent;
      bone.turns = parent >= 0 ? parent : bone.from;
    }
    if (bone.from < 0 || bone.turns < 0) {
      return RetargetFault(absl::StrCat("joint map: '", EscapeControls(entry.joint), "': '",
                                        EscapeControls(bone.from < 0 ? entry.from : turns_with),
                                        "' is no joint of the clip, which has ",
                                        ListJointNames(source, kMaxNamed)));
    }
    from_of[static_cast<size_t>(bone.bone)] = bone.from;
    bones.push_back(bone);
  }
  std::ranges::sort(bones, {}, &ResolvedBone::bone);
  if (bones.empty() || bones[0].bone != 0) {
    return RetargetFault(absl::StrCat("joint map: the root '", skeleton.joint(0).name,
                                      "' of the character must be driven"));
  }
  for (ResolvedBone& bone : bones) {
    int above = skeleton.parent(bone.bone);
    while (above >= 0 && from_of[static_cast<size_t>(above)] < 0) above = skeleton.parent(above);
    bone.begin = above < 0 ? bone.from : from_of[static_cast<size_t>(above)];
  }
  return bones;
}

}  // namespace pleat
