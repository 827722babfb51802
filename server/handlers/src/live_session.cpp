#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "grpc_status.h"
#include "pleat/base/status.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "run_unary.h"
#include "session_messages.h"
#include "stream_handlers.h"

namespace pleat {
namespace {

// A cycle: one request is computed, its frame is written while the next request is read, and when
// both have ended the next cycle starts. So there is one message of each kind in memory, and a
// client that does not read its frames stops being read.
class LiveReactor final
    : public grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse> {
 public:
  explicit LiveReactor(HandlerContext* context) : slot_(context), context_(context) {
    num_pending_ = 1;
    StartRead(&request_);
  }

  void OnReadDone(bool ok) override { Ended(ok, &reading_ended_); }
  void OnWriteDone(bool ok) override { Ended(ok, &writing_failed_); }
  void OnCancel() override {}  // read and write end with ok = false
  void OnDone() override { delete this; }

 private:
  void Ended(bool ok, std::atomic<bool>* flag) {
    if (!ok) *flag = true;
    if (--num_pending_ == 0) {
      context_->pose_executor->Post([this] { Cycle(); });
    }
  }

  // `this` may be gone as soon as reading and writing have been started.
  void Cycle() {
    absl::Status status;
    if (writing_failed_) status = absl::CancelledError("the client is gone");
    const bool ended = reading_ended_ || !status.ok();
    if (!ended) status = CallGuarded([&] { return Answer(); });
    if (!ended && status.ok()) {
      num_pending_ = 2;
      StartRead(&request_);
      StartWrite(&response_);
      return;
    }
    if (!writing_failed_) LogFailure("LiveSession", status);
    session_.reset();
    Finish(ToGrpcStatus(status));
  }

  absl::Status Answer() {
    PLEAT_RETURN_IF_ERROR(slot_.status());
    response_.Clear();
    if (session_ == nullptr) return Start();
    if (request_.part_case() != v1::LiveSessionRequest::kPose) {
      return absl::InvalidArgumentError("after the start, every message of a session is a pose");
    }
    return Show(request_.pose());
  }

  absl::Status Start() {
    if (request_.part_case() != v1::LiveSessionRequest::kStart) {
      return absl::InvalidArgumentError("the first message of a session must be its start");
    }
    const v1::LiveSessionRequest::Start& start = request_.start();
    PLEAT_ASSIGN_OR_RETURN(SessionRequest opening, FromProto(start.character(), start.options()));
    PLEAT_ASSIGN_OR_RETURN(
        session_, context_->service->OpenSession(opening.model_id, std::move(opening.options)));
    *response_.mutable_header() = ToProto(session_->header());
    return absl::OkStatus();
  }

  absl::Status Show(const v1::LiveSessionRequest::LivePose& request) {
    if (request.history_size() >= kMaxHistory) {
      return absl::InvalidArgumentError("pose.history has more than 7 entries");
    }
    PLEAT_ASSIGN_OR_RETURN(const Pose pose, FromProto(request.pose()));
    PLEAT_ASSIGN_OR_RETURN(const std::vector<Pose> history,
                           FromProto(request.history(), "pose.history"));
    if (request.keyframe()) session_->RequestKeyframe();
    absl::StatusOr<EncodedFrame> frame;
    if (history.empty()) {
      frame = session_->ShowNext(pose, request.restart());
    } else {
      std::vector<const Pose*> poses{&pose};
      for (const Pose& earlier : history) poses.push_back(&earlier);
      frame = session_->Show(poses);
    }
    PLEAT_RETURN_IF_ERROR(frame.status());
    *response_.mutable_frame() = ToProto(request.number(), *std::move(frame));
    return absl::OkStatus();
  }

  StreamSlot slot_;
  HandlerContext* context_;
  v1::LiveSessionRequest request_;
  v1::LiveSessionResponse response_;
  std::unique_ptr<PoseSession> session_;
  std::atomic<int> num_pending_ = 0;  // reads and writes under way
  std::atomic<bool> reading_ended_ = false, writing_failed_ = false;
};

}  // namespace

grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse>* LiveSession(
    HandlerContext* context) {
  return new LiveReactor(context);
}

}  // namespace pleat
