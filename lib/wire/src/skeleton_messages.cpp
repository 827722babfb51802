#include "pleat/wire/skeleton_messages.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr size_t kMaxRequestIdBytes = 64;

v1::Vector3 ToProto(const Eigen::Vector3d& vector) {
  v1::Vector3 message;
  message.set_x(vector.x());
  message.set_y(vector.y());
  message.set_z(vector.z());
  return message;
}

absl::StatusOr<Eigen::Vector3d> FromProto(const v1::Vector3& message, absl::string_view what) {
  const Eigen::Vector3d vector(message.x(), message.y(), message.z());
  if (!vector.allFinite()) {
    return absl::InvalidArgumentError(absl::StrCat(what, " is not finite"));
  }
  return vector;
}

// Reads the pose and checks only its number of rotations. The caller checks the values: CheckPose
// for a single pose, PoseTrack::Create for a track.
absl::StatusOr<Pose> ReadPose(const v1::Pose& message) {
  if (message.rotations_size() < 1 || message.rotations_size() > kMaxWireJoints) {
    return absl::InvalidArgumentError(absl::StrCat("pose.rotations has ", message.rotations_size(),
                                                   " entries, allowed are 1 to ", kMaxWireJoints));
  }
  Pose pose;
  const v1::Vector3& root = message.root_position();
  pose.root_position << root.x(), root.y(), root.z();
  pose.rotations.reserve(message.rotations_size());
  for (const v1::Quaternion& q : message.rotations()) {
    pose.rotations.emplace_back(q.w(), q.x(), q.y(), q.z());
  }
  return pose;
}

absl::Status Inside(const std::string& what, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat(what, ": ", absl::string_view(status.message())));
}

}  // namespace

absl::Status CheckName(const std::string& name, absl::string_view what) {
  if (name.size() <= kMaxWireNameBytes) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(what, " has ", name.size(), " bytes, the limit is ", kMaxWireNameBytes));
}

absl::Status CheckRequestId(const std::string& id) {
  if (id.size() <= kMaxRequestIdBytes) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("request_id has ", id.size(), " bytes, the limit is ", kMaxRequestIdBytes));
}

v1::FrameRate ToProto(const FrameRate& frame_rate) {
  v1::FrameRate message;
  message.set_numerator(frame_rate.numerator);
  message.set_denominator(frame_rate.denominator);
  return message;
}

absl::StatusOr<FrameRate> FromProto(const v1::FrameRate& message) {
  if (message.numerator() <= 0 || message.denominator() <= 0) {
    return absl::InvalidArgumentError(absl::StrCat("frame_rate ", message.numerator(), "/",
                                                   message.denominator(), " is not positive"));
  }
  return FrameRate{message.numerator(), message.denominator()};
}

v1::Skeleton ToProto(const Skeleton& skeleton) {
  v1::Skeleton message;
  for (const Joint& joint : skeleton.joints()) {
    v1::Joint* out = message.add_joints();
    out->set_name(ToValidUtf8(joint.name));
    out->set_parent(joint.parent);
    *out->mutable_rest_position() = ToProto(joint.rest_position);
  }
  return message;
}

absl::StatusOr<Skeleton> FromProto(const v1::Skeleton& message) {
  if (message.joints_size() > kMaxWireJoints) {
    return absl::InvalidArgumentError(absl::StrCat("skeleton.joints has ", message.joints_size(),
                                                   " entries, the limit is ", kMaxWireJoints));
  }
  std::vector<Joint> joints;
  for (int j = 0; j < message.joints_size(); ++j) {
    const std::string what = absl::StrCat("skeleton.joints[", j, "]");
    const v1::Joint& in = message.joints(j);
    PLEAT_RETURN_IF_ERROR(CheckName(in.name(), absl::StrCat(what, ".name")));
    PLEAT_ASSIGN_OR_RETURN(Eigen::Vector3d position,
                           FromProto(in.rest_position(), absl::StrCat(what, ".rest_position")));
    joints.push_back({in.name(), in.parent(), position});
  }
  return Skeleton::Create(std::move(joints));
}

v1::Pose ToProto(const Pose& pose) {
  v1::Pose message;
  *message.mutable_root_position() = ToProto(pose.root_position);
  for (const Eigen::Quaterniond& rotation : pose.rotations) {
    v1::Quaternion* out = message.add_rotations();
    out->set_w(rotation.w());
    out->set_x(rotation.x());
    out->set_y(rotation.y());
    out->set_z(rotation.z());
  }
  return message;
}

absl::StatusOr<Pose> FromProto(const v1::Pose& message) {
  PLEAT_ASSIGN_OR_RETURN(Pose pose, ReadPose(message));
  PLEAT_RETURN_IF_ERROR(CheckPose(pose));
  return pose;
}

absl::StatusOr<std::vector<Pose>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::Pose>& messages, absl::string_view what) {
  std::vector<Pose> poses;
  poses.reserve(messages.size());
  for (int i = 0; i < messages.size(); ++i) {
    absl::StatusOr<Pose> pose = FromProto(messages[i]);
    if (!pose.ok()) return Inside(absl::StrCat(what, "[", i, "]"), pose.status());
    poses.push_back(*std::move(pose));
  }
  return poses;
}

v1::PoseTrack ToProto(const PoseTrack& track) {
  v1::PoseTrack message;
  message.set_fps(track.fps());
  for (const Pose& pose : track.poses()) *message.add_poses() = ToProto(pose);
  for (const int start : track.clip_starts()) message.add_clip_starts(start);
  return message;
}

absl::StatusOr<PoseTrack> FromProto(const v1::PoseTrack& message) {
  // Only limits of the wire are checked here; PoseTrack::Create checks what holds for every track.
  if (!(message.fps() >= .01 && message.fps() <= 10000)) {
    return absl::InvalidArgumentError(
        absl::StrCat("track.fps is ", message.fps(), ", allowed are .01 to 10000"));
  }
  PoseTrack::Parts parts{.fps = message.fps()};
  parts.poses.reserve(message.poses_size());
  for (int t = 0; t < message.poses_size(); ++t) {
    absl::StatusOr<Pose> pose = ReadPose(message.poses(t));
    if (!pose.ok()) return Inside(absl::StrCat("track.poses[", t, "]"), pose.status());
    parts.poses.push_back(*std::move(pose));
  }
  if (message.clip_starts_size() > 0) {
    parts.clip_starts.assign(message.clip_starts().begin(), message.clip_starts().end());
  }
  absl::StatusOr<PoseTrack> track = PoseTrack::Create(std::move(parts));
  if (!track.ok()) return Inside("track", track.status());
  return track;
}

v1::ErrorSummary ToProto(const ErrorSummary& summary) {
  v1::ErrorSummary message;
  message.set_mean_percent(summary.mean_percent);
  message.set_rms_percent(summary.rms_percent);
  message.set_p95_percent(summary.p95_percent);
  message.set_max_percent(summary.max_percent);
  message.set_mean_mm(summary.mean_mm);
  message.set_motion_mean_percent(summary.motion_mean_percent);
  return message;
}

ErrorSummary FromProto(const v1::ErrorSummary& message) {
  ErrorSummary summary;
  summary.mean_percent = message.mean_percent();
  summary.rms_percent = message.rms_percent();
  summary.p95_percent = message.p95_percent();
  summary.max_percent = message.max_percent();
  summary.mean_mm = message.mean_mm();
  summary.motion_mean_percent = message.motion_mean_percent();
  return summary;
}

}  // namespace pleat
