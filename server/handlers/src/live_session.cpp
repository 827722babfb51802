#include <grpcpp/server_context.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/call_reactor.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/reactors/run_unary.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "session_messages.h"

namespace pleat {
namespace {

// What a message may take once it is parsed. Eight poses of 18 joints take 20 kB.
constexpr uint64_t kMaxLiveMessageBytes = uint64_t{256} << 10;

double SecondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// One live session: poses come in, frames go out, at the pace of the slower side.
//
// Three activities overlap, each at most once: a read (reading_), a computation (working_) and a
// write (writing_). Their ends arrive on different threads: OnReadDone, OnWriteDone and OnCancel on
// those of gRPC, the start of the session on the pose executor, OnReply on a thread of the service,
// Drain and Abandon on the thread that shuts the server down. All of them take mutex_, note what
// has happened and call Advance, which alone decides what starts next. So nobody waits for anybody,
// and a session that has nothing to do occupies no thread.
//
// Stages: kNew until the first message; kStarting while the model is loaded, when nothing is read;
// kOpen from then on. The end is a stage of its own in all but name: once Ended() holds, Advance
// starts nothing any more, waits for the computation and the write under way (both use response_,
// and both come back to Advance) and calls Finish, once. A read may still be under way then; it
// ends by itself and finds finished_ set.
//
// Credits bound what waits. The pose stream says by HasRoom() whether another pose may be read and
// by ready() whether the client has acknowledged enough frames for the next reply, so a client that
// sends faster than it reads is held back by its own flow control. The computation starts only when
// the write before it is over: hence one response_ serves both, one frame per session is in memory,
// and a client that does not read stops its own session and nobody else's. When the input has
// ended, no acknowledgement can come, and the poses that wait are answered without credits.
//
// The order matters in three places. An acknowledgement counts before the pose that carries it, for
// it may free the credit that the pose needs. Answered starts the write before it calls Advance:
// between them the lock is held, so nobody sees a session with neither a computation nor a write,
// and ends it with a frame unsent. And the pose stream, which holds the model, is destroyed before
// Finish: the client that reads the status may delete the model right after.
class LiveReactor final
    : public CallReactor<grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse>>,
      public Drainable,
      private LiveListener {
 public:
  LiveReactor(HandlerContext* context, grpc::CallbackServerContext* call)
      : CallReactor(context),
        slot_(context, kStreamBytes + kMaxLiveMessageBytes),
        context_(context),
        call_(call) {}

  // A server that begins to drain meanwhile either finds the entry or has set `draining` before.
  void Start() {
    entry_.emplace(&context_->calls->live_sessions, this);
    Advance(std::unique_lock(mutex_));
  }

  void OnReadDone(bool ok) override {
    std::unique_lock lock(mutex_);
    reading_ = false;
    if (finished_) return;  // a message that came too late; nobody waits for it
    if (ok && request_.SpaceUsedLong() > kMaxLiveMessageBytes) {
      v1::LiveSessionRequest().Swap(&request_);  // Clear would keep the memory
      Keep(absl::InvalidArgumentError(
          absl::StrCat("a message of a live session takes more than ", kMaxLiveMessageBytes,
                       " bytes of memory; no pose with its history does")));
    } else if (ok) {
      Keep(CallGuarded([this] { return Accept(); }));
    } else {
      input_ended_ = true;
    }
    Advance(std::move(lock));
  }
  void OnWriteDone(bool ok) override {
    std::unique_lock lock(mutex_);
    writing_ = false;
    if (ok) context_->calls->TellFrameStep("send", SecondsSince(write_began_));
    if (!ok) cancelled_ = true;
    Advance(std::move(lock));
  }
  void OnCancel() override {
    std::unique_lock lock(mutex_);
    cancelled_ = true;
    Advance(std::move(lock));
  }

  void Drain() override { Advance(std::unique_lock(mutex_)); }
  void Abandon() override {
    std::lock_guard lock(mutex_);
    if (!finished_) call_->TryCancel();  // call_ is gone some time after Finish
  }

 private:
  enum class Stage { kNew, kStarting, kOpen };

  // The first error is the reason of the end.
  void Keep(absl::Status status) {
    if (status_.ok()) status_ = std::move(status);
  }

  // Takes in request_. Call it with mutex_ held.
  absl::Status Accept() {
    if (stage_ == Stage::kNew) {
      if (request_.part_case() != v1::LiveSessionRequest::kStart) {
        return absl::InvalidArgumentError("the first message of a session must be its start");
      }
      stage_ = Stage::kStarting;
      return absl::OkStatus();
    }
    if (request_.part_case() == v1::LiveSessionRequest::kAcknowledgement) {
      return stream_->Acknowledge(request_.acknowledgement().frames_received());
    }
    if (request_.part_case() != v1::LiveSessionRequest::kPose) {
      return absl::InvalidArgumentError(
          "after the start, every message of a session is a pose or an acknowledgement");
    }
    PLEAT_RETURN_IF_ERROR(stream_->Acknowledge(request_.pose().frames_received()));
    stream_->Push(FromProto(request_.pose()));
    return absl::OkStatus();
  }

  bool HasWork() const {
    if (stage_ != Stage::kOpen) return stage_ == Stage::kStarting;
    return stream_->ready() || (input_ended_ && !stream_->empty());
  }
  bool WantsToRead() const {
    return stage_ == Stage::kNew || (stage_ == Stage::kOpen && stream_->HasRoom());
  }
  bool Ended() const { return cancelled_ || !status_.ok() || (input_ended_ && !HasWork()); }

  // Starts what can be started, or ends the session. `lock` holds mutex_.
  void Advance(std::unique_lock<std::mutex> lock) {
    if (finished_) return;
    if (context_->calls->draining) Keep(absl::UnavailableError("the server is shutting down"));
    if (Ended()) {
      if (working_ || writing_) return;  // they come back here
      finished_ = true;
      if (cancelled_) {
        Keep(absl::CancelledError("the client is gone"));
      } else {
        const RequestScope scope(request());
        LogFailure("LiveSession", status_);
      }
      const grpc::Status status = ToGrpcStatus(status_);
      stream_.reset();
      lock.unlock();
      Finish(status);
      return;
    }
    if (!reading_ && !input_ended_ && WantsToRead()) {
      reading_ = true;
      StartRead(&request_);
    }
    if (!working_ && !writing_ && HasWork()) {
      working_ = true;
      if (stage_ == Stage::kOpen) {
        stream_->Answer();
      } else {
        Post(context_->pose_executor, [this] { Answered(CallGuarded([this] { return Open(); })); });
      }
    }
  }

  // Nothing else touches response_ until it is written.
  void OnReply(LiveReply&& reply) override {
    const auto hold = Hold();  // Answered may end the call, and gRPC lets go of it
    Answered(CallGuarded([&] {
      Fill(std::move(reply));
      return absl::OkStatus();
    }));
  }

  // Sends what is in response_, or ends the session.
  void Answered(absl::Status status) {
    std::unique_lock lock(mutex_);
    working_ = false;
    Keep(std::move(status));
    if (!cancelled_ && status_.ok()) {
      writing_ = true;
      write_began_ = std::chrono::steady_clock::now();
      StartWrite(&response_);
    }
    Advance(std::move(lock));
  }

  // The header as the first response. Reads request_ without the lock: no read is under way.
  absl::Status Open() {
    PLEAT_RETURN_IF_ERROR(slot_.status());
    response_.Clear();
    const v1::LiveSessionRequest::Start& start = request_.start();
    PLEAT_ASSIGN_OR_RETURN(const LiveRules rules, RulesOf(start));
    PLEAT_ASSIGN_OR_RETURN(SessionRequest opening, FromProto(start.character(), start.options()));
    PLEAT_ASSIGN_OR_RETURN(
        std::unique_ptr<PoseStream> stream,
        context_->poses->OpenStream(opening.model_id, std::move(opening.options), rules, this));
    *response_.mutable_header() = ToProto(stream->header());
    std::lock_guard lock(mutex_);
    stream_ = std::move(stream);
    stage_ = Stage::kOpen;
    return absl::OkStatus();
  }

  // A pose that cannot be shown is an answer, not an error.
  void Fill(LiveReply&& reply) {
    response_.Clear();
    *response_.mutable_report() = ReportOf(reply);
    if (reply.frame.ok()) {
      TellSteps(*reply.frame, *context_->calls);
      *response_.mutable_frame() = ToProto(reply.number, *std::move(reply.frame));
    } else {
      *response_.mutable_rejection() = RejectionOf(reply.number, reply.frame.status());
    }
  }

  StreamSlot slot_;
  HandlerContext* const context_;
  grpc::CallbackServerContext* const call_;
  v1::LiveSessionResponse response_;  // belongs to what is working_ or writing_

  std::mutex mutex_;  // guards all below but entry_
  v1::LiveSessionRequest request_;
  Stage stage_ = Stage::kNew;
  std::unique_ptr<PoseStream> stream_;  // from kOpen to finished_
  absl::Status status_;                 // why the session ends
  bool reading_ = false, writing_ = false, working_ = false;
  std::chrono::steady_clock::time_point write_began_;
  bool input_ended_ = false, cancelled_ = false, finished_ = false;
  std::optional<LiveRegistry::Entry> entry_;  // the last member, so that it goes first
};

}  // namespace

grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse>* LiveSession(
    HandlerContext* context, grpc::CallbackServerContext* call) {
  return StartReactor<LiveReactor>(context, call);
}

}  // namespace pleat
