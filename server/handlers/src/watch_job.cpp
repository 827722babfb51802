#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/reactors/run_unary.h"
#include "pleat/wire/service_messages.h"

namespace pleat {
namespace {

// Changes of the job and ends of writes both lead to Pump, which sends the newest state when
// nothing is being written: a slow reader misses steps in between and never builds up a backlog.
class WatchReactor final : public grpc::ServerWriteReactor<v1::WatchJobResponse>,
                           public std::enable_shared_from_this<WatchReactor> {
 public:
  static WatchReactor* Start(HandlerContext* context, std::string job_id) {
    const std::shared_ptr<WatchReactor> reactor(new WatchReactor(context));
    reactor->self_ = reactor;
    context->storage_executor->Post(
        [reactor, job_id = std::move(job_id)] { reactor->Open(job_id); });
    return reactor.get();
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
  void OnDone() override {
    subscription_.reset();  // no call of the listener is left
    self_.reset();          // tasks that are still posted keep the object and find it finished
  }

 private:
  explicit WatchReactor(HandlerContext* context) : slot_(context), context_(context) {}

  void Open(const std::string& job_id) {
    absl::Status status = slot_.status();
    if (status.ok()) {
      // Until open_ is set, what the listener starts does nothing.
      absl::StatusOr<std::unique_ptr<JobSubscription>> subscription =
          context_->jobs->Subscribe(job_id, [this] { Schedule(); });
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
    context_->storage_executor->Post([self = shared_from_this()] { self->Pump(); });
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
    // One of the flags keeps everybody else out; gRPC may call back from inside.
    if (write) {
      StartWrite(&message_);
    } else {
      Finish(ToGrpcStatus(status));
    }
  }

  // Fills the message with the newest state when the client has not got it. Called with the lock.
  bool TakeNews() {
    const JobUpdate update = subscription_->current();
    if (cancelled_ || (sent_any_ && update.revision == sent_revision_)) return false;
    sent_any_ = true;
    sent_revision_ = update.revision;
    sent_final_ = IsFinal(update.info.state);
    *message_.mutable_job() = ToProto(update.info);
    return true;
  }

  // True when nothing more will be sent; `status` says why. Called with the lock.
  bool IsOver(absl::Status* status) const {
    if (cancelled_) {
      *status = absl::CancelledError("the client gave up");
    } else if (!sent_final_ && (context_->draining || !subscription_->status().ok())) {
      *status = absl::UnavailableError("the server is shutting down; watch the job again later");
    }
    return sent_final_ || !status->ok();
  }

  StreamSlot slot_;
  HandlerContext* context_;
  std::shared_ptr<WatchReactor> self_;  // until OnDone
  std::unique_ptr<JobSubscription> subscription_;

  std::mutex mutex_;  // all below
  v1::WatchJobResponse message_;
  bool open_ = false, writing_ = false, cancelled_ = false, finished_ = false;
  bool sent_any_ = false, sent_final_ = false;
  uint64_t sent_revision_ = 0;
};

}  // namespace

grpc::ServerWriteReactor<v1::WatchJobResponse>* WatchJob(HandlerContext* context,
                                                         const v1::WatchJobRequest& request) {
  return WatchReactor::Start(context, request.id());
}

}  // namespace pleat
