#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/call_reactor.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/reactors/run_unary.h"
#include "pleat/wire/service_messages.h"

namespace pleat {
namespace {

// Changes of the job, ends of writes and the cancellation all lead to Pump, which sends the newest
// state when nothing is being written: a slow reader misses steps in between and never builds up a
// backlog. Any number of Pumps may wait or run at the same time (call_reactor.h); the mutex makes
// one of them act, and the flag that it leaves behind keeps the others out.
class WatchReactor final : public CallReactor<grpc::ServerWriteReactor<v1::WatchJobResponse>> {
 public:
  WatchReactor(HandlerContext* context, std::string job_id)
      : CallReactor(context), slot_(context), context_(context), job_id_(std::move(job_id)) {}

  void Start() {
    Post(context_->storage_executor, [this] { Open(); });
  }
  void OnWriteDone(bool ok) override {
    {
      std::lock_guard lock(mutex_);
      writing_ = false;
      if (!ok) cancelled_ = true;
    }
    Schedule();
  }
  void OnCancel() override {
    {
      std::lock_guard lock(mutex_);
      cancelled_ = true;
    }
    Schedule();
  }

 private:
  void Open() {
    absl::Status status = slot_.status();
    if (status.ok()) {
      // The job may change before Subscribe returns. Until open_ is set, the Pumps that the
      // listener schedules do nothing; the one below sees what they would have seen.
      absl::StatusOr<std::unique_ptr<JobSubscription>> subscription =
          context_->jobs->Subscribe(job_id_, [this] { Schedule(); });
      status = subscription.status();
      if (status.ok()) subscription_ = *std::move(subscription);
    }
    if (!status.ok()) {
      LogFailure("WatchJob", status);
      {
        std::lock_guard lock(mutex_);
        finished_ = true;
      }
      Finish(ToGrpcStatus(status));
      return;
    }
    {
      std::lock_guard lock(mutex_);
      open_ = true;
    }
    Pump();
  }

  void Schedule() {
    Post(context_->storage_executor, [this] { Pump(); });
  }

  void Pump() {
    bool write = false;
    absl::Status status;
    {
      std::lock_guard lock(mutex_);
      if (!open_ || writing_ || finished_) return;
      write = TakeNews();
      if (!write && !IsOver(&status)) return;
      writing_ = write;
      finished_ = !write;
    }
    if (write) {
      StartWrite(&message_);
      return;
    }
    subscription_.reset();  // waits for a listener that runs, so not under the mutex
    Finish(ToGrpcStatus(status));
  }

  // Fills the message with the newest state when the client does not have it yet. Call it with
  // mutex_ held.
  bool TakeNews() {
    const JobUpdate update = subscription_->current();
    if (cancelled_ || (sent_any_ && update.revision == sent_revision_)) return false;
    sent_any_ = true;
    sent_revision_ = update.revision;
    sent_final_ = IsFinal(update.info.state);
    *message_.mutable_job() = ToProto(update.info);
    return true;
  }

  // True when nothing more will be sent; `status` says why. Call it with mutex_ held.
  bool IsOver(absl::Status* status) const {
    if (cancelled_) {
      *status = absl::CancelledError("the client gave up");
    } else if (!sent_final_ && (context_->calls->draining || !subscription_->status().ok())) {
      *status = absl::UnavailableError("the server is shutting down; watch the job again later");
    }
    return sent_final_ || !status->ok();
  }

  StreamSlot slot_;
  HandlerContext* const context_;
  const std::string job_id_;
  std::unique_ptr<JobSubscription> subscription_;  // from open_ to finished_

  std::mutex mutex_;              // guards all below
  v1::WatchJobResponse message_;  // left alone while writing_
  bool open_ = false, writing_ = false, cancelled_ = false, finished_ = false;
  bool sent_any_ = false, sent_final_ = false;
  uint64_t sent_revision_ = 0;
};

}  // namespace

grpc::ServerWriteReactor<v1::WatchJobResponse>* WatchJob(HandlerContext* context,
                                                         const v1::WatchJobRequest& request) {
  return StartReactor<WatchReactor>(context, request.id());
}

}  // namespace pleat
