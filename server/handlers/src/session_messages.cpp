#include "session_messages.h"

#include <ctime>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/wire/limit_messages.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"

namespace pleat {

absl::StatusOr<SessionRequest> FromProto(const v1::Character& character,
                                         const v1::StreamOptions& options) {
  PLEAT_ASSIGN_OR_RETURN(CharacterQuery query, FromProto(character));
  SessionRequest request;
  request.model_id = std::move(query.model_id);
  request.options.bone_scales = std::move(query.bone_scales);
  request.options.skinned_only = query.skinned_only;
  request.options.strengths = std::move(query.strengths);
  PLEAT_ASSIGN_OR_RETURN(request.options.encoder, FromProto(options));
  return request;
}

v1::Frame ToProto(uint64_t number, EncodedFrame frame) {
  v1::Frame message;
  message.set_number(number);
  *message.mutable_draco() = std::move(frame.draco);
  if (frame.parameters) *message.mutable_parameters() = ToProto(*frame.parameters);
  message.set_confidence(frame.confidence);
  message.set_difference(!frame.mark.keyframe);
  message.set_checksum(frame.mark.checksum);
  return message;
}

void TellSteps(const EncodedFrame& frame, const ServerCalls& calls) {
  calls.TellFrameStep("query", 1e-6 * frame.evaluate_us);
  calls.TellFrameStep("encode", 1e-6 * frame.encode_us);
}

absl::StatusOr<LiveRules> RulesOf(const v1::LiveSessionRequest::Start& start) {
  LiveRules rules;
  rules.latest_wins = start.latest_wins();
  if (start.max_in_flight() == 0) return rules;
  if (start.max_in_flight() < 0 || start.max_in_flight() > kMaxPosesInFlight) {
    return absl::InvalidArgumentError(absl::StrCat("max_in_flight is ", start.max_in_flight(),
                                                   ", allowed are 0 to ", kMaxPosesInFlight));
  }
  rules.max_in_flight = start.max_in_flight();
  return rules;
}

namespace {

absl::Status Read(const v1::LiveSessionRequest::LivePose& message, LivePose* pose) {
  if (message.history_size() >= kMaxPosesPerQuery) {
    return absl::InvalidArgumentError("pose.history has more than 7 entries");
  }
  PLEAT_ASSIGN_OR_RETURN(pose->pose, FromProto(message.pose()));
  PLEAT_ASSIGN_OR_RETURN(pose->history, FromProto(message.history(), "pose.history"));
  return absl::OkStatus();
}

// How long all threads of the process have computed since its start.
uint64_t ProcessorMicroseconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<uint64_t>(time.tv_sec) * 1'000'000 +
         static_cast<uint64_t>(time.tv_nsec) / 1000;
}

}  // namespace

LivePose FromProto(const v1::LiveSessionRequest::LivePose& message) {
  LivePose pose{
      .number = message.number(), .restart = message.restart(), .keyframe = message.keyframe()};
  pose.status = Read(message, &pose);
  return pose;
}

v1::PoseRejection RejectionOf(uint64_t number, const absl::Status& status) {
  v1::PoseRejection message;
  message.set_number(number);
  message.set_code(static_cast<int>(status.code()));
  message.set_message(ToGrpcStatus(status).error_message());
  AddLimitDetails(status, message.mutable_details());
  return message;
}

v1::LiveReport ReportOf(const LiveReply& reply) {
  v1::LiveReport message;
  message.set_num_superseded(static_cast<uint32_t>(reply.num_superseded));
  message.set_queue_us(static_cast<uint32_t>(reply.queue_us));
  if (reply.frame.ok()) {
    message.set_evaluate_us(static_cast<uint32_t>(reply.frame->evaluate_us));
    message.set_encode_us(static_cast<uint32_t>(reply.frame->encode_us));
    message.set_evaluated_together(static_cast<uint32_t>(reply.num_together));
  }
  message.set_server_cpu_us(ProcessorMicroseconds());
  return message;
}

}  // namespace pleat
