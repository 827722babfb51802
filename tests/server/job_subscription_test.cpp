// A job of a server as a client follows it over a socket.
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "server/running_service.h"
#include "server/watch_to_end.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

class JobSubscriptionTest : public testing::Test {
 protected:
  // A job that does not end before the trainer is released.
  std::string CreateJob() {
    running_.trainer().Hold();
    const std::string id = running_.service().sequences().Upload(MakeSwayingTube(5), {})->id;
    return running_.service().jobs().CreateTraining({.sequence_ids = {id}})->id;
  }

  RunningService running_{Reach::kSocket};
};

TEST_F(JobSubscriptionTest, WatchesAgainWhenTheServerComesBack) {
  const std::string job = CreateJob();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto subscription,
                             running_.service().jobs().Subscribe(job, [] {}));
  running_.RestartServer(0);
  running_.trainer().Release();
  EXPECT_EQ(WatchToEnd(running_.local().jobs(), job).state, JobState::kSucceeded);
  while (!IsFinal(subscription->current().info.state)) {
    ASSERT_THAT(subscription->status(), IsOk());
    std::this_thread::yield();
  }
}

TEST_F(JobSubscriptionTest, EndsWithAReasonWhenNoServerComesBack) {
  const std::string job = CreateJob();
  RemoteOptions options;
  options.max_attempts = 2;
  const auto client = RemoteCharacterService::Connect(running_.address(), options).value();
  std::mutex mutex;
  std::condition_variable changed;
  bool rung = false;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto subscription, client->jobs().Subscribe(job, [&] {
    std::lock_guard lock(mutex);
    rung = true;  // with news, or because it has ended
    changed.notify_all();
  }));
  running_.server().Shutdown(0);
  std::unique_lock lock(mutex);
  while (subscription->status().ok()) {
    changed.wait(lock, [&] { return rung; });
    rung = false;
  }
  EXPECT_THAT(subscription->status(), HasStatus(absl::StatusCode::kUnavailable, testing::_));
  ASSERT_THAT(running_.local().jobs().Cancel(job), IsOk());
}

TEST_F(JobSubscriptionTest, CanBeGivenUpAtAnyTime) {
  const std::string job = CreateJob();
  for (int i = 0; i < 5; ++i) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto subscription,
                               running_.service().jobs().Subscribe(job, [] {}));
    EXPECT_FALSE(IsFinal(subscription->current().info.state));
  }
  ASSERT_THAT(running_.service().jobs().Cancel(job), IsOk());
}

}  // namespace
}  // namespace pleat
