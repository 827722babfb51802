#include "pleat/motion/apply_edits.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "blending.h"
#include "body_axes.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/math/rotations.h"
#include "pleat/motion/clean_feet.h"
#include "pose_edits.h"
#include "time_edits.h"

namespace pleat {
namespace {

// "all" is every joint but the root; of a blend it is the root too.
absl::StatusOr<std::vector<int>> JointsOf(const Skeleton& skeleton, const MotionEdit& edit) {
  std::vector<bool> chosen(static_cast<size_t>(skeleton.num_joints()), false);
  for (const std::string& name : edit.joints) {
    if (name == "all") {
      std::fill(chosen.begin() + (edit.kind == EditKind::kBlend ? 0 : 1), chosen.end(), true);
      continue;
    }
    const int joint = skeleton.FindJoint(name);
    if (joint < 0) {
      return absl::InvalidArgumentError(absl::StrCat(
          "the character has no joint '", EscapeControls(name), "'; there are all, ",
          absl::StrJoin(skeleton.joints(), ", ",
                        [](std::string* out, const Joint& known) { out->append(known.name); })));
    }
    chosen[static_cast<size_t>(joint)] = true;
  }
  std::vector<int> joints;
  for (size_t j = 0; j < chosen.size(); ++j) {
    if (chosen[j]) joints.push_back(static_cast<int>(j));
  }
  return joints;
}

Eigen::Vector3d VectorOf(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

class Editor {
 public:
  Editor(const Skeleton& skeleton, Motion motion, const MotionEdit& edit)
      : skeleton_(skeleton), motion_(std::move(motion)), edit_(edit) {}

  absl::StatusOr<Motion> Apply() && {
    PLEAT_ASSIGN_OR_RETURN(joints_, JointsOf(skeleton_, edit_));
    switch (edit_.kind) {
      case EditKind::kBoneScale:
        SetFactors(edit_.Number(0), &motion_.bone_scales);
        break;
      case EditKind::kDetail:
        SetFactors(edit_.Number(0), &motion_.detail_strengths);
        break;
      case EditKind::kVertexDetail:
        motion_.vertex_strengths.assign(edit_.numbers[0].begin(), edit_.numbers[0].end());
        break;
      case EditKind::kOffsetRotation:
      case EditKind::kScaleRotation:
      case EditKind::kOffsetRoot:
      case EditKind::kLimit:
      case EditKind::kSmooth:
      case EditKind::kMirror: {
        PLEAT_RETURN_IF_ERROR(EditPoses());
        break;
      }
      default: {
        PLEAT_ASSIGN_OR_RETURN(motion_.track, EditTime());
      }
    }
    return std::move(motion_);
  }

 private:
  void SetFactors(double factor, std::vector<double>* factors) {
    if (factors->empty()) factors->assign(static_cast<size_t>(skeleton_.num_joints()), 1.0);
    for (const int j : joints_) (*factors)[static_cast<size_t>(j)] = factor;
  }

  absl::Status EditPoses() {
    PoseTrack::Parts parts = std::move(motion_.track).Take();
    std::vector<Pose>* poses = &parts.poses;
    switch (edit_.kind) {
      case EditKind::kOffsetRotation:
        OffsetRotations(
            joints_, Eigen::Quaterniond(RotationFromEulerXyz(kDegree * VectorOf(edit_.numbers[0]))),
            poses);
        break;
      case EditKind::kScaleRotation:
        ScaleRotations(joints_, edit_.Number(0), poses);
        break;
      case EditKind::kOffsetRoot:
        for (Pose& pose : *poses) pose.root_position += VectorOf(edit_.numbers[0]);
        break;
      case EditKind::kLimit:
        LimitRotations(skeleton_, joints_, kDegree * edit_.Number(0), kDegree * edit_.Number(1),
                       poses);
        break;
      case EditKind::kSmooth:
        SmoothRotations(joints_, edit_.Number(0), parts.fps, parts.clip_starts, poses);
        break;
      default: {
        PLEAT_ASSIGN_OR_RETURN(const BodyAxes axes, FindBodyAxes(skeleton_));
        MirrorPoses(axes, parts.clip_starts, poses);
        for (std::vector<double>* factors : {&motion_.bone_scales, &motion_.detail_strengths}) {
          const std::vector<double> before = *factors;
          for (size_t j = 0; j < before.size(); ++j) {
            (*factors)[j] = before[static_cast<size_t>(axes.mirror_joints[j])];
          }
        }
      }
    }
    PLEAT_ASSIGN_OR_RETURN(motion_.track, PoseTrack::Create(std::move(parts)));
    return absl::OkStatus();
  }

  absl::StatusOr<PoseTrack> EditTime() {
    const PoseTrack& track = motion_.track;
    switch (edit_.kind) {
      case EditKind::kTimeScale:
        return ScaleTime(track, edit_.Number(0));
      case EditKind::kTimeWarp:
        return WarpTime(track, edit_.numbers[0], edit_.numbers[1]);
      case EditKind::kResample:
        return ResampleTime(track, edit_.Number(0));
      case EditKind::kTrim:
        return TrimTime(track, edit_.Number(0), edit_.Number(1));
      case EditKind::kCleanFeet: {
        PLEAT_ASSIGN_OR_RETURN(const LegJoints legs, FindLegJoints(skeleton_));
        CleanFeetSummary summary;
        return CleanFeet(skeleton_, track, TrackContacts(skeleton_, legs, track), {}, &summary);
      }
      default:
        break;
    }
    PLEAT_ASSIGN_OR_RETURN(const BodyAxes axes, FindBodyAxes(skeleton_));
    if (edit_.kind == EditKind::kLoop) {
      return LoopTrack(track, edit_.Number(0), static_cast<int>(edit_.Number(1)), axes);
    }
    PLEAT_ASSIGN_OR_RETURN(const Motion other,
                           WithContext("the other motion", DecodeMotion(edit_.other, skeleton_)));
    if (edit_.kind == EditKind::kBlend) {
      return BlendTracks(track, other.track, joints_, edit_.Number(0), axes);
    }
    return ConcatenateTracks(track, other.track, edit_.Number(0), axes);
  }

  const Skeleton& skeleton_;
  Motion motion_;
  const MotionEdit& edit_;
  std::vector<int> joints_;
};

}  // namespace

absl::StatusOr<Motion> ApplyEdit(const Skeleton& skeleton, Motion motion, const MotionEdit& edit) {
  assert(CheckEdit(edit).ok());
  return WithContext(std::string(FormOf(edit.kind).name),
                     Editor(skeleton, std::move(motion), edit).Apply());
}

absl::StatusOr<Motion> ApplyHistory(const Skeleton& skeleton, const EditHistory& history,
                                    const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(Motion motion, DecodeMotion(history.source, skeleton, limits));
  for (size_t i = 0; i < history.edits.size(); ++i) {
    PLEAT_ASSIGN_OR_RETURN(motion,
                           WithContext(absl::StrCat("edits[", i, "]"),
                                       ApplyEdit(skeleton, std::move(motion), history.edits[i])));
  }
  return motion;
}

absl::StatusOr<std::string> AddEdit(const Skeleton& skeleton, std::string_view text,
                                    MotionEdit edit, const MeshLimits& limits) {
  PLEAT_RETURN_IF_ERROR(CheckEdit(edit));
  PLEAT_ASSIGN_OR_RETURN(EditHistory history, DecodeEditHistory(text, limits));
  if (history.edits.size() == kMaxEdits) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the motion has ", kMaxEdits, " edits, which is the limit"));
  }
  history.edits.push_back(std::move(edit));
  PLEAT_ASSIGN_OR_RETURN(const Motion motion, ApplyHistory(skeleton, history, limits));
  return EncodeEditedMotion(skeleton, motion, history);
}

absl::StatusOr<std::string> UndoEdits(std::string_view text, int count, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(EditHistory history, DecodeEditHistory(text, limits));
  const auto num_edits = static_cast<int>(history.edits.size());
  if (count < 1 || count > num_edits) {
    return absl::InvalidArgumentError(
        absl::StrCat("the motion has ", num_edits, " edits: ", count, " cannot be undone"));
  }
  if (count == num_edits) return std::move(history.source);
  history.edits.resize(static_cast<size_t>(num_edits - count));
  PLEAT_ASSIGN_OR_RETURN(const std::optional<Skeleton> skeleton,
                         DecodeMotionSkeleton(text, limits));
  if (!skeleton) return absl::InvalidArgumentError("the motion has edits and no 'skeleton'");
  PLEAT_ASSIGN_OR_RETURN(const Motion motion, ApplyHistory(*skeleton, history, limits));
  return EncodeEditedMotion(*skeleton, motion, history);
}

}  // namespace pleat
