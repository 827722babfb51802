// A watch whose client, job and server act at the same time: the test plays gRPC and the job.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <latch>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "pleat/handlers/stream_handlers.h"
#include "server/reactors/fake_call.h"
#include "support/checkpoint.h"
#include "support/held_executor.h"
#include "support/mock_services.h"

namespace pleat {
namespace {

// The job of the test, and what its one subscriber sees of it.
class WatchedJob {
 public:
  std::unique_ptr<JobSubscription> Subscribe(std::function<void()> listener) {
    std::lock_guard lock(mutex_);
    listener_ = std::move(listener);
    return std::make_unique<Subscription>(this);
  }
  // Without a subscriber nobody hears of it.
  void Change(JobState state, double fraction) {
    std::lock_guard lock(mutex_);
    update_.info.state = state;
    update_.info.fraction = fraction;
    ++update_.revision;
    if (listener_) listener_();
  }
  void End(absl::Status status) {
    std::lock_guard lock(mutex_);
    status_ = std::move(status);
    if (listener_) listener_();
  }
  bool is_watched() const {
    std::lock_guard lock(mutex_);
    return listener_ != nullptr;
  }

 private:
  struct Subscription final : JobSubscription {
    explicit Subscription(WatchedJob* watched) : job(watched) {}
    ~Subscription() override {
      std::lock_guard lock(job->mutex_);
      job->listener_ = nullptr;
    }
    JobUpdate current() const override {
      std::lock_guard lock(job->mutex_);
      return job->update_;
    }
    absl::Status status() const override {
      std::lock_guard lock(job->mutex_);
      return job->status_;
    }
    WatchedJob* const job;
  };

  mutable std::mutex mutex_;
  // Guarded by mutex_.
  std::function<void()> listener_;
  JobUpdate update_{.info = {}, .revision = 1};
  absl::Status status_;
};

class WatchJobRaces : public testing::Test {
 protected:
  WatchJobRaces() {
    spdlog::set_level(spdlog::level::off);
    context_.jobs = &jobs_;
    context_.storage_executor = executor_.get();
    context_.calls->max_open_streams = 1;
    ON_CALL(jobs_, Subscribe).WillByDefault([this](auto&&, std::function<void()> listener) {
      return job_.Subscribe(std::move(listener));
    });
  }
  void Start() { call_.emplace(WatchJob(&context_, {})); }
  // Two tasks of one executor with the test between them: what is posted after it waits until the
  // result is counted down.
  std::shared_ptr<std::latch> Block() {
    auto latch = std::make_shared<std::latch>(1);
    executor_.get()->Post([latch] { latch->wait(); });
    return latch;
  }
  void ExpectEnd(grpc::StatusCode code) {
    const grpc::Status status = call_->WaitForFinish();
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    EXPECT_FALSE(job_.is_watched()) << "the subscription goes before the status";
    call_->WaitForEnd();
    context_.calls->open_calls.WaitUntilNone();
  }

  WatchedJob job_;
  testing::NiceMock<MockJobService> jobs_;
  HandlerContext context_;
  HeldExecutor executor_;
  std::optional<FakeWriteCall<v1::WatchJobResponse>> call_;
};

TEST_F(WatchJobRaces, AClientThatIsGoneBeforeTheFirstMessageGetsNone) {
  Start();
  call_->Cancel();
  executor_.Release();
  ExpectEnd(grpc::StatusCode::CANCELLED);
}

TEST_F(WatchJobRaces, AClientThatIsGoneWhileTheServiceSubscribesGetsNone) {
  Checkpoint subscribing;
  EXPECT_CALL(jobs_, Subscribe).WillOnce([&](auto&&, std::function<void()> listener) {
    subscribing.Pass();
    return job_.Subscribe(std::move(listener));
  });
  executor_.Release();
  Start();
  subscribing.WaitUntilReached();
  call_->Cancel();
  EXPECT_FALSE(call_->finished());
  subscribing.Release();
  ExpectEnd(grpc::StatusCode::CANCELLED);
}

TEST_F(WatchJobRaces, CancelledWhileItWritesItEndsAfterTheWrite) {
  executor_.Release();
  Start();
  call_->WaitForWrite();
  call_->Cancel();
  job_.Change(JobState::kSucceeded, 1);
  executor_.RunAll();
  EXPECT_FALSE(call_->finished());
  call_->EndWrite(false);
  ExpectEnd(grpc::StatusCode::CANCELLED);
}

TEST_F(WatchJobRaces, AClientThatIsGoneBetweenTwoMessagesEndsIt) {
  executor_.Release();
  Start();
  call_->Receive();
  executor_.RunAll();
  EXPECT_FALSE(call_->finished() || call_->writing()) << "there is no news";
  call_->Cancel();
  ExpectEnd(grpc::StatusCode::CANCELLED);
}

TEST_F(WatchJobRaces, AChangeBeforeTheSubscriptionIsThereIsNotMissed) {
  EXPECT_CALL(jobs_, Subscribe).WillOnce([&](auto&&, std::function<void()> listener) {
    auto subscription = job_.Subscribe(std::move(listener));
    job_.Change(JobState::kSucceeded, 1);
    return subscription;
  });
  executor_.Release();
  Start();
  EXPECT_EQ(call_->Receive().job().state(), v1::JOB_STATE_SUCCEEDED);
  ExpectEnd(grpc::StatusCode::OK);
}

TEST_F(WatchJobRaces, AReaderThatIsSlowGetsTheNewestStateAlone) {
  executor_.Release();
  Start();
  EXPECT_EQ(call_->WaitForWrite().job().state(), v1::JOB_STATE_QUEUED);
  for (const double fraction : {.25, .5, .75}) job_.Change(JobState::kRunning, fraction);
  executor_.RunAll();
  call_->EndWrite();
  EXPECT_EQ(call_->Receive().job().fraction(), .75);
  job_.Change(JobState::kSucceeded, 1);
  EXPECT_EQ(call_->Receive().job().state(), v1::JOB_STATE_SUCCEEDED);
  ExpectEnd(grpc::StatusCode::OK);
}

TEST_F(WatchJobRaces, AServerThatDrainsWhileItWritesStillSendsTheNewestState) {
  executor_.Release();
  Start();
  call_->WaitForWrite();
  context_.calls->draining = true;
  job_.Change(JobState::kRunning, .5);
  call_->EndWrite();
  EXPECT_EQ(call_->Receive().job().state(), v1::JOB_STATE_RUNNING);
  ExpectEnd(grpc::StatusCode::UNAVAILABLE);
}

TEST_F(WatchJobRaces, AServiceThatShutsDownEndsItAtOnce) {
  executor_.Release();
  Start();
  call_->Receive();
  job_.End(absl::UnavailableError("shutting down"));
  ExpectEnd(grpc::StatusCode::UNAVAILABLE);
}

TEST_F(WatchJobRaces, TheFinalStateEndsItWellWhateverElseHappens) {
  executor_.Release();
  Start();
  call_->Receive();
  job_.Change(JobState::kFailed, .5);
  call_->WaitForWrite();
  context_.calls->draining = true;
  job_.End(absl::UnavailableError("shutting down"));
  call_->EndWrite();
  ExpectEnd(grpc::StatusCode::OK);
}

// The changes and the cancellation of a call wait on the executor when gRPC lets go of it.
TEST_F(WatchJobRaces, TasksThatAreStillQueuedFindTheCallEnded) {
  executor_.Release();
  Start();
  call_->WaitForWrite();
  const auto before = Block();
  call_->EndWrite(false);  // queues the task that ends the call
  const auto after = Block();
  job_.Change(JobState::kRunning, .5);
  job_.Change(JobState::kSucceeded, 1);
  call_->Cancel();
  before->count_down();
  EXPECT_EQ(call_->WaitForEnd().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_FALSE(context_.calls->open_calls.WaitUntilNone({})) << "the tasks keep the reactor alive";
  after->count_down();
  context_.calls->open_calls.WaitUntilNone();
}

TEST_F(WatchJobRaces, ChangesAndWritesMayEndAtTheSameTime) {
  Executor several(3);
  context_.storage_executor = &several;
  Start();
  std::thread changing([this] {
    for (int i = 1; i <= 200; ++i) job_.Change(JobState::kRunning, i / 200.0);
    job_.Change(JobState::kSucceeded, 1);
  });
  double last = 0;
  v1::WatchJobResponse response;
  do {
    response = call_->Receive();
    EXPECT_GE(response.job().fraction(), last);
    last = response.job().fraction();
  } while (response.job().state() != v1::JOB_STATE_SUCCEEDED && !testing::Test::HasFailure());
  ExpectEnd(grpc::StatusCode::OK);
  changing.join();
}

}  // namespace
}  // namespace pleat
