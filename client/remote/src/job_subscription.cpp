#include "job_subscription.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "pleat/wire/service_messages.h"

namespace pleat {
namespace {

// Follows one job by a thread of its own, which reads one watch after the other. Listeners are
// called on this thread, without the mutex, so they may ask for the state. The destructor cancels
// the watch that is being read and waits for the thread; a listener must not destroy the
// subscription.
class RemoteSubscription final : public JobSubscription {
 public:
  RemoteSubscription(const RemoteState* state, const std::string& id,
                     std::function<void()> listener)
      : state_(state), id_(id), listener_(std::move(listener)) {
    thread_ = std::thread([this] { Follow(); });
  }
  ~RemoteSubscription() override {
    {
      std::lock_guard lock(mutex_);
      stopped_ = true;
      if (context_ != nullptr) context_->TryCancel();
    }
    thread_.join();
  }

  // Waits until the first state is there. When none will come, it returns the reason.
  absl::Status WaitForFirst() {
    std::unique_lock lock(mutex_);
    first_.wait(lock, [this] { return update_.revision > 0 || !status_.ok(); });
    return update_.revision > 0 ? absl::OkStatus() : status_;
  }

  JobUpdate current() const override {
    std::lock_guard lock(mutex_);
    return update_;
  }
  absl::Status status() const override {
    std::lock_guard lock(mutex_);
    return status_;
  }

 private:
  // Reads one watch after the other until the job has ended or there is no hope.
  void Follow() {
    for (int attempt = 1;; ++attempt) {
      bool final = false;
      absl::Status status = ReadWatch(&attempt, &final);
      if (final) return;
      const bool again = IsTransient(status) && attempt < state_->options.max_attempts &&
                         BackOff(attempt, Progress({}, [this] { return stopped_.load(); }));
      if (again) continue;
      if (status.ok()) status = absl::UnavailableError("the server ended the watch too early");
      {
        std::lock_guard lock(mutex_);
        status_ = std::move(status);
      }
      first_.notify_all();
      listener_();
      return;
    }
  }

  // Reads one watch to its end. Every state that arrives sets *attempt back to 1, since a server
  // that answers deserves all attempts again.
  absl::Status ReadWatch(int* attempt, bool* final) {
    grpc::ClientContext context;
    {
      std::lock_guard lock(mutex_);
      if (stopped_) return absl::CancelledError("nobody watches any more");
      context_ = &context;
    }
    v1::WatchJobRequest request;
    request.set_id(id_);
    const auto reader = state_->jobs->WatchJob(&context, request);
    v1::WatchJobResponse response;
    absl::Status status;
    while (status.ok() && !*final && reader->Read(&response)) {
      *attempt = 1;
      absl::StatusOr<JobInfo> info = FromProto(response.job());
      status = info.status();
      if (!status.ok()) break;
      *final = IsFinal(info->state);
      {
        std::lock_guard lock(mutex_);
        update_.info = *std::move(info);
        ++update_.revision;
      }
      first_.notify_all();
      listener_();
    }
    if (!status.ok()) context.TryCancel();
    const absl::Status end = FromGrpcStatus(reader->Finish());
    std::lock_guard lock(mutex_);
    context_ = nullptr;
    return status.ok() ? end : status;
  }

  const RemoteState* const state_;
  const std::string id_;
  const std::function<void()> listener_;
  std::atomic<bool> stopped_ = false;

  mutable std::mutex mutex_;  // guards the next three
  std::condition_variable first_;
  grpc::ClientContext* context_ = nullptr;  // that of the watch that is being read, or null
  JobUpdate update_;                        // revision 0: nothing has come yet
  absl::Status status_;
  std::thread thread_;  // declared last, because it uses all of the above
};

}  // namespace

absl::StatusOr<std::unique_ptr<JobSubscription>> OpenRemoteSubscription(
    const RemoteState* state, const std::string& id, std::function<void()> listener) {
  auto subscription = std::make_unique<RemoteSubscription>(state, id, std::move(listener));
  if (absl::Status status = subscription->WaitForFirst(); !status.ok()) return status;
  return subscription;
}

}  // namespace pleat
