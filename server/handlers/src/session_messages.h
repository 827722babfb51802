// The messages of pose sessions and their C++ types.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/reactors/handler_context.h"
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
// Tells those who measure how long the frame took to evaluate and to encode.
void TellSteps(const EncodedFrame& frame, const ServerCalls& calls);

// kInvalidArgument when the credits are out of range.
absl::StatusOr<LiveRules> RulesOf(const v1::LiveSessionRequest::Start& start);
// A pose that cannot be read is no error here: its status says what is wrong with it.
LivePose FromProto(const v1::LiveSessionRequest::LivePose& message);
v1::PoseRejection RejectionOf(uint64_t number, const absl::Status& status);
v1::LiveReport ReportOf(const LiveReply& reply);

}  // namespace pleat
