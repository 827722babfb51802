#include "cli/io/motion_edit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/exit_code.h"
#include "pleat/base/status.h"
#include "pleat/math/rotations.h"
#include "pleat/skeleton/pose_history.h"

namespace pleat {
namespace {

constexpr int kMaxEditedFrames = 1'000'000;

struct JointValue {
  std::vector<int> joints;
  std::string value;
};

absl::StatusOr<JointValue> SplitJointValue(const std::vector<std::string>& joint_names,
                                           const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, absl::MaxSplits('=', 1));
  if (parts.size() != 2) {
    return UsageError(absl::StrCat("'", text, "' is not JOINT=VALUE"));
  }
  JointValue result{{}, parts[1]};
  for (int j = 0; j < static_cast<int>(joint_names.size()); ++j) {
    if (joint_names[j] == parts[0] || (parts[0] == "all" && j > 0)) result.joints.push_back(j);
  }
  if (result.joints.empty()) {
    return UsageError(absl::StrCat("'", text, "': no joint is called '", parts[0],
                                   "'; there are all, ", absl::StrJoin(joint_names, ", ")));
  }
  return result;
}

absl::StatusOr<double> ParseNumber(const std::string& value, const std::string& text) {
  double number;
  if (!absl::SimpleAtod(value, &number) || !std::isfinite(number)) {
    return UsageError(absl::StrCat("'", text, "': '", value, "' is not a number"));
  }
  return number;
}

absl::StatusOr<Eigen::Vector3d> ParseVector(const std::string& value, const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(value, ',');
  if (parts.size() != 3) {
    return UsageError(absl::StrCat("'", text, "': '", value, "' is not three numbers x,y,z"));
  }
  Eigen::Vector3d vector;
  for (int axis = 0; axis < 3; ++axis) {
    PLEAT_ASSIGN_OR_RETURN(vector[axis], ParseNumber(parts[axis], text));
  }
  return vector;
}

absl::Status ScaleRotations(const std::vector<std::string>& joint_names,
                            const std::vector<std::string>& texts, std::vector<Pose>* poses) {
  for (const std::string& text : texts) {
    PLEAT_ASSIGN_OR_RETURN(const JointValue given, SplitJointValue(joint_names, text));
    PLEAT_ASSIGN_OR_RETURN(const double factor, ParseNumber(given.value, text));
    for (const int j : given.joints) {
      Eigen::Vector3d previous = Eigen::Vector3d::Zero();
      for (Pose& pose : *poses) {
        // Rotations are unwrapped along time. Otherwise a turn past 180 degrees would jump when it
        // is scaled.
        previous = UnwrapExponentialMap(ExponentialMapFromQuaternion(pose.rotations[j]), previous);
        pose.rotations[j] = QuaternionFromExponentialMap(factor * previous);
      }
    }
  }
  return absl::OkStatus();
}

absl::Status OffsetRotations(const std::vector<std::string>& joint_names,
                             const std::vector<std::string>& texts, std::vector<Pose>* poses) {
  for (const std::string& text : texts) {
    PLEAT_ASSIGN_OR_RETURN(const JointValue given, SplitJointValue(joint_names, text));
    PLEAT_ASSIGN_OR_RETURN(const Eigen::Vector3d degrees, ParseVector(given.value, text));
    const Eigen::Quaterniond offset(RotationFromEulerXyz(degrees * (std::numbers::pi / 180)));
    for (const int j : given.joints) {
      for (Pose& pose : *poses) {
        pose.rotations[j] = (offset * pose.rotations[j]).normalized();
      }
    }
  }
  return absl::OkStatus();
}

// Resamples every clip on its own, so that history still does not cross a boundary.
absl::StatusOr<PoseTrack> ScaleTime(const PoseTrack& track, double time_scale) {
  if (!(time_scale >= 0.01 && time_scale <= 100)) {
    return UsageError(absl::StrCat("--time-scale ", time_scale, " is outside 0.01 to 100"));
  }
  if (time_scale == 1) return track;
  if (track.num_frames() * time_scale > kMaxEditedFrames) {
    return UsageError(absl::StrCat("--time-scale ", time_scale, " makes more than ",
                                   kMaxEditedFrames, " frames"));
  }
  PoseTrack::Parts scaled{.fps = track.fps(), .clip_starts = {}};
  for (const int begin : track.clip_starts()) {
    const int end = track.ClipOf(begin).end;
    scaled.clip_starts.push_back(static_cast<int>(scaled.poses.size()));
    const long last = std::lround((end - begin - 1) * time_scale);
    for (long t = 0; t <= last; ++t) {
      const double position = std::min<double>(begin + t / time_scale, end - 1);
      scaled.poses.push_back(SamplePose(track, begin, end, position));
    }
  }
  return PoseTrack::Create(std::move(scaled));
}

}  // namespace

absl::StatusOr<PoseTrack> EditMotion(const std::vector<std::string>& joint_names, PoseTrack track,
                                     const MotionEdits& edits) {
  PoseTrack::Parts edited = std::move(track).Take();
  PLEAT_RETURN_IF_ERROR(ScaleRotations(joint_names, edits.scale_rotation, &edited.poses));
  PLEAT_RETURN_IF_ERROR(OffsetRotations(joint_names, edits.offset_rotation, &edited.poses));
  for (const std::string& text : edits.offset_root) {
    PLEAT_ASSIGN_OR_RETURN(const Eigen::Vector3d offset_m, ParseVector(text, text));
    for (Pose& pose : edited.poses) pose.root_position += offset_m;
  }
  PLEAT_ASSIGN_OR_RETURN(track, PoseTrack::Create(std::move(edited)));
  return ScaleTime(track, edits.time_scale);
}

absl::StatusOr<std::vector<double>> ParseJointFactors(const std::vector<std::string>& joint_names,
                                                      const std::vector<std::string>& texts) {
  std::vector<double> factors;
  if (texts.empty()) return factors;
  factors.assign(joint_names.size(), 1.0);
  for (const std::string& text : texts) {
    PLEAT_ASSIGN_OR_RETURN(const JointValue given, SplitJointValue(joint_names, text));
    PLEAT_ASSIGN_OR_RETURN(const double factor, ParseNumber(given.value, text));
    for (const int j : given.joints) factors[j] = factor;
  }
  return factors;
}

}  // namespace pleat
