#include <memory>
#include <utility>

#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/pull_stream.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "session_messages.h"

namespace pleat {
namespace {

struct Clip {
  PoseService* poses;
  v1::EvaluateClipRequest request;
  std::unique_ptr<ClipSession> session = nullptr;

  absl::StatusOr<bool> Next(v1::EvaluateClipResponse* response) {
    if (session == nullptr) {
      PLEAT_ASSIGN_OR_RETURN(SessionRequest opening,
                             FromProto(request.character(), request.options()));
      PLEAT_ASSIGN_OR_RETURN(PoseTrack track, FromProto(request.track()));
      PLEAT_ASSIGN_OR_RETURN(
          session, poses->OpenClip(opening.model_id, std::move(track), std::move(opening.options)));
      request.Clear();
      *response->mutable_header() = ToProto(session->header());
      return true;
    }
    if (session->done()) return false;
    const int number = session->next_frame();
    PLEAT_ASSIGN_OR_RETURN(EncodedFrame frame, session->Next());
    *response->mutable_frame() = ToProto(static_cast<uint64_t>(number), std::move(frame));
    return true;
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::EvaluateClipResponse>* EvaluateClip(
    HandlerContext* context, const v1::EvaluateClipRequest& request) {
  const auto clip = std::make_shared<Clip>(Clip{context->poses, request});
  return StartReactor<PullStream<v1::EvaluateClipResponse>>(
      context, context->pose_executor, "EvaluateClip",
      [clip](v1::EvaluateClipResponse* response) { return clip->Next(response); });
}

}  // namespace pleat
