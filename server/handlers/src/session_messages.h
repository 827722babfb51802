// Pose sessions on the wire.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/service/pose_service.h"
#include "pleat/v1/pose_service.pb.h"

namespace pleat {

struct SessionRequest {
  std::string model_id;
  PoseSessionOptions options;
};
absl::StatusOr<SessionRequest> FromProto(const v1::Character& character,
                                         const v1::StreamOptions& options);

v1::Frame ToProto(uint64_t number, EncodedFrame frame);

// kInvalidArgument when the credits are out of range.
absl::StatusOr<LiveRules> RulesOf(const v1::LiveSessionRequest::Start& start);
// What is wrong with the pose is its status.
LivePose FromProto(const v1::LiveSessionRequest::LivePose& message);
v1::PoseRejection RejectionOf(uint64_t number, const absl::Status& status);
v1::LiveReport ReportOf(const LiveReply& reply);

}  // namespace pleat
