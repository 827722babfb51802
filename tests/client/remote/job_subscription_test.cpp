// A watch over a server that says what the test wants; with real jobs it is tested in tests/server.
#include "job_subscription.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "absl/synchronization/notification.h"
#include "client/remote/scripted_server.h"
#include "pleat/wire/service_messages.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Return;
using JobWriter = grpc::ServerWriter<v1::WatchJobResponse>;

class JobSubscriptionScriptTest : public testing::Test {
 protected:
  // A script of one watch: these states with rising fractions, then the end.
  auto Show(std::vector<JobState> states, std::function<grpc::Status()> end) {
    return [states, end](grpc::ServerContext*, const v1::WatchJobRequest* request, JobWriter* out) {
      JobInfo info;
      info.id = request->id();
      for (const JobState state : states) {
        info.state = state;
        v1::WatchJobResponse response;
        *response.mutable_job() = ToProto(info);
        out->Write(response);
      }
      return end();
    };
  }
  // The states that WatchJob shows, and how it ends.
  absl::Status Watch(int max_attempts = 2) {
    const auto client = server_.Open({.max_attempts = max_attempts});
    return WatchJob(client->jobs(), "j", [this](const JobInfo& info) {
      EXPECT_EQ(info.id, "j");
      last_ = info.state;
      return true;
    });
  }

  JobState last_ = JobState::kQueued;
  absl::Notification over_;
  ScriptedServer server_;
};

grpc::Status Fine() { return grpc::Status::OK; }

TEST_F(JobSubscriptionScriptTest, EndsWithTheFinalStateThoughTheServerDoesNot) {
  EXPECT_CALL(server_.jobs, WatchJob)
      .WillOnce(Show({JobState::kRunning, JobState::kSucceeded}, [this] {
        over_.WaitForNotification();
        return Fine();
      }));
  EXPECT_THAT(Watch(), IsOk());
  EXPECT_EQ(last_, JobState::kSucceeded);
  over_.Notify();
}

TEST_F(JobSubscriptionScriptTest, AWatchThatBreaksOffIsBegunAgain) {
  EXPECT_CALL(server_.jobs, WatchJob)
      .WillOnce(Return(Unavailable()))
      .WillOnce(Show({JobState::kQueued}, Unavailable))
      .WillOnce(Show({JobState::kRunning}, Unavailable))
      .WillOnce(Show({JobState::kCancelled}, Fine));
  EXPECT_THAT(Watch(), IsOk());
  EXPECT_EQ(last_, JobState::kCancelled);
}

TEST_F(JobSubscriptionScriptTest, AWatchWithoutAnEndIsNoSuccess) {
  EXPECT_CALL(server_.jobs, WatchJob).WillOnce(Show({JobState::kRunning}, Fine));
  EXPECT_THAT(Watch(), HasStatus(absl::StatusCode::kUnavailable, HasSubstr("too early")));
  EXPECT_EQ(last_, JobState::kRunning);
}

TEST_F(JobSubscriptionScriptTest, WhereNoStateComesThereIsNoSubscription) {
  for (const auto& [end, code] : {std::pair(Refusal(), absl::StatusCode::kPermissionDenied),
                                  std::pair(Fine(), absl::StatusCode::kUnavailable)}) {
    EXPECT_CALL(server_.jobs, WatchJob).WillOnce(Return(end));
    const auto client = server_.Open();
    EXPECT_EQ(client->jobs().Subscribe("j", [] {}).status().code(), code);
  }
}

TEST_F(JobSubscriptionScriptTest, AStateThatIsNoneEndsTheWatchWithItsField) {
  EXPECT_CALL(server_.jobs, WatchJob).WillOnce([](auto*, auto*, JobWriter* out) {
    v1::WatchJobResponse response;
    response.mutable_job()->set_id("j");
    while (out->Write(response)) {  // until the client hangs up
    }
    return Fine();
  });
  EXPECT_THAT(Watch(), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("state")));
}

TEST_F(JobSubscriptionScriptTest, RevisionsGrowAndTheListenerIsCalledForEachAndForTheEnd) {
  EXPECT_CALL(server_.jobs, WatchJob)
      .WillOnce(Show({JobState::kQueued, JobState::kRunning}, Refusal));
  const auto client = server_.Open();
  absl::Mutex mutex;
  int num_calls = 0;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto subscription, client->jobs().Subscribe("j", [&] {
    absl::MutexLock lock(&mutex);
    ++num_calls;
  }));
  {
    absl::MutexLock lock(&mutex);
    mutex.Await(absl::Condition(
        +[](int* n) { return *n == 3; }, &num_calls));
  }
  EXPECT_EQ(subscription->current().revision, 2u);
  EXPECT_THAT(subscription->status(), HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
}

}  // namespace
}  // namespace pleat
