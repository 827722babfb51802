// Frame rates, skeletons, poses and errors on the wire. Messages come from outside: each FromProto
// that returns a status checks them, and kInvalidArgument names the field that is wrong.
#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/error_metrics.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skeleton/skeleton.h"
#include "pleat/v1/common.pb.h"

namespace pleat {

inline constexpr int kMaxWireJoints = 1024;
inline constexpr int kMaxWireNameBytes = 256;

// OK when `name` has at most kMaxWireNameBytes bytes. kInvalidArgument calls it `what`.
absl::Status CheckName(const std::string& name, absl::string_view what);
// kInvalidArgument when the id of a request is longer than 64 bytes.
absl::Status CheckRequestId(const std::string& id);

v1::FrameRate ToProto(const FrameRate& frame_rate);
absl::StatusOr<FrameRate> FromProto(const v1::FrameRate& message);

v1::Skeleton ToProto(const Skeleton& skeleton);
absl::StatusOr<Skeleton> FromProto(const v1::Skeleton& message);

v1::Pose ToProto(const Pose& pose);
// Takes any number of joints up to kMaxWireJoints; the evaluator compares it with its skeleton.
absl::StatusOr<Pose> FromProto(const v1::Pose& message);
// Errors name message i as "what[i]".
absl::StatusOr<std::vector<Pose>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::Pose>& messages, absl::string_view what);

v1::PoseTrack ToProto(const PoseTrack& track);
absl::StatusOr<PoseTrack> FromProto(const v1::PoseTrack& message);

v1::ErrorSummary ToProto(const ErrorSummary& summary);  // leaves out frame_mean_percent
ErrorSummary FromProto(const v1::ErrorSummary& message);

}  // namespace pleat
