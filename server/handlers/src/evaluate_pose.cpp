#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/skeleton_messages.h"
#include "session_messages.h"

namespace pleat {

absl::Status EvaluatePose(HandlerContext& context, const v1::EvaluatePoseRequest& request,
                          v1::EvaluatePoseResponse* response) {
  if (request.poses_size() < 1 || request.poses_size() > kMaxPosesPerQuery) {
    return absl::InvalidArgumentError("poses must have 1 to 8 entries");
  }
  PLEAT_ASSIGN_OR_RETURN(const std::vector<Pose> poses, FromProto(request.poses(), "poses"));
  PLEAT_ASSIGN_OR_RETURN(SessionRequest session_request,
                         FromProto(request.character(), request.options()));
  PLEAT_ASSIGN_OR_RETURN(
      const std::unique_ptr<PoseSession> session,
      context.poses->OpenSession(session_request.model_id, std::move(session_request.options)));
  std::vector<const Pose*> pointers;
  for (const Pose& pose : poses) pointers.push_back(&pose);
  PLEAT_ASSIGN_OR_RETURN(EncodedFrame frame, session->Show(pointers));
  TellSteps(frame, *context.calls);
  *response->mutable_frame() = ToProto(0, std::move(frame));
  return absl::OkStatus();
}

}  // namespace pleat
