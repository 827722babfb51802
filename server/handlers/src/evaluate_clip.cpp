#include <memory>
#include <utility>

#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/pull_stream.h"
#include "pleat/skeleton/human_template.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "session_messages.h"

namespace pleat {
namespace {

// What a pose takes once it is no message any more: a rotation per joint and the root.
constexpr uint64_t kBytesPerPose = sizeof(Pose) + kNumHumanJoints * sizeof(Eigen::Quaterniond);

struct Clip {
  PoseService* poses;
  const ServerCalls* calls;
  v1::EvaluateClipRequest request;
  absl::StatusOr<Reservation> memory;  // not OK: why there is none for the request
  std::unique_ptr<ClipSession> session = nullptr;

  absl::StatusOr<bool> Next(v1::EvaluateClipResponse* response) {
    if (session == nullptr) {
      PLEAT_RETURN_IF_ERROR(memory.status());
      PLEAT_ASSIGN_OR_RETURN(SessionRequest opening,
                             FromProto(request.character(), request.options()));
      PLEAT_ASSIGN_OR_RETURN(PoseTrack track, FromProto(request.track()));
      PLEAT_ASSIGN_OR_RETURN(
          session, poses->OpenClip(opening.model_id, std::move(track), std::move(opening.options)));
      const auto num_poses = static_cast<uint64_t>(request.track().poses_size());
      request = v1::EvaluateClipRequest();  // Clear would keep the memory
      memory->ShrinkTo(num_poses * kBytesPerPose);
      *response->mutable_header() = ToProto(session->header());
      return true;
    }
    if (session->done()) return false;
    const int number = session->next_frame();
    PLEAT_ASSIGN_OR_RETURN(EncodedFrame frame, session->Next());
    TellSteps(frame, *calls);
    *response->mutable_frame() = ToProto(static_cast<uint64_t>(number), std::move(frame));
    return true;
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::EvaluateClipResponse>* EvaluateClip(
    HandlerContext* context, const v1::EvaluateClipRequest& request) {
  // gRPC keeps its message until the call ends; taken out of it, it can go earlier.
  v1::EvaluateClipRequest taken;
  taken.Swap(const_cast<v1::EvaluateClipRequest*>(&request));
  absl::StatusOr<Reservation> memory = Reservation();
  if (context->calls->request_memory != nullptr) {
    memory = context->calls->request_memory->Reserve(taken.SpaceUsedLong(), "this clip");
    if (!memory.ok()) taken = v1::EvaluateClipRequest();
  }
  const auto clip = std::make_shared<Clip>(
      Clip{context->poses, context->calls.get(), std::move(taken), std::move(memory)});
  return StartReactor<PullStream<v1::EvaluateClipResponse>>(
      context, context->pose_executor, "EvaluateClip",
      [clip](v1::EvaluateClipResponse* response) { return clip->Next(response); },
      TurnKind::kBulk);  // live sessions share the threads
}

}  // namespace pleat
