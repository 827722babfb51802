#include "channel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/synchronization/notification.h"
#include "client/remote/scripted_server.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/wire/limit_messages.h"
#include "pleat/wire/service_messages.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Return;

class ChannelTest : public testing::Test {
 protected:
  absl::Notification over_;  // the server may answer
  ScriptedServer server_;
};

TEST_F(ChannelTest, EveryErrorOfTheServerKeepsItsCodeAndItsWords) {
  const auto client = server_.Open();
  for (int code = 1; code <= 16; ++code) {
    EXPECT_CALL(server_.models, DeleteModel)
        .WillOnce(Return(grpc::Status(static_cast<grpc::StatusCode>(code), "because")));
    EXPECT_THAT(client->models().Delete("m"),
                HasStatus(static_cast<absl::StatusCode>(code), "because"));
  }
}

TEST_F(ChannelTest, CallsThatChangeNothingAreRepeatedWhenTheServerWasNotReached) {
  const auto client = server_.Connect();
  EXPECT_CALL(server_.models, DeleteModel)
      .WillOnce(Return(Unavailable()))
      .WillOnce(Return(Unavailable()))
      .WillOnce(Return(grpc::Status::OK));
  EXPECT_THAT(client->models().Delete("m"), IsOk());
  EXPECT_CALL(server_.models, GetModel).WillOnce(Return(Refusal()));  // an answer is an answer
  EXPECT_THAT(client->models().Get("m"),
              HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
}

// A creation may be repeated because it has an id; a cancellation has none.
TEST_F(ChannelTest, ALostCreationIsRepeatedWithTheSameIdAndNothingElseIs) {
  const auto client = server_.Open({.max_attempts = 2});
  std::vector<std::string> ids;
  EXPECT_CALL(server_.jobs, CreateTrainingJob)
      .Times(2)
      .WillRepeatedly([&](grpc::ServerContext*, const v1::CreateTrainingJobRequest* request,
                          v1::CreateTrainingJobResponse* response) {
        ids.push_back(request->request_id());
        if (ids.size() == 1) return Unavailable();
        JobInfo info;
        info.id = "job-1";
        *response->mutable_job() = ToProto(info);
        return grpc::Status::OK;
      });
  EXPECT_CALL(server_.jobs, CreateCompressionJob).Times(2).WillRepeatedly(Return(Unavailable()));
  EXPECT_CALL(server_.jobs, CancelJob).WillOnce(Return(Unavailable()));
  const auto unavailable = HasStatus(absl::StatusCode::kUnavailable, "the server restarts");
  EXPECT_EQ(client->jobs().CreateTraining({})->id, "job-1");
  EXPECT_EQ(ids[0].size(), 32u);
  EXPECT_EQ(ids[0], ids[1]);
  EXPECT_THAT(client->jobs().CreateCompression({"s", {}}), unavailable);
  EXPECT_THAT(client->jobs().Cancel("j"), unavailable);
}

grpc::Status RefusedFor(std::optional<absl::Duration> wait) {
  const absl::Status status =
      RefuseForLimit({.limit = "--max-streams-per-client", .retry_after = wait}, "too many");
  return grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, "too many", LimitDetailsOf(status));
}

TEST_F(ChannelTest, ACallThatALimitRefusedIsMadeAgainWhenTheServerSaid) {
  const auto client = server_.Open();
  EXPECT_CALL(server_.jobs, CancelJob)
      .WillOnce(Return(RefusedFor(absl::Milliseconds(1))))
      .WillOnce(Return(RefusedFor(absl::Milliseconds(1))))
      .WillOnce(Return(grpc::Status::OK));
  EXPECT_THAT(client->jobs().Cancel("j"), IsOk());
}

TEST_F(ChannelTest, WaitingThatDoesNotHelpIsNotTried) {
  const auto client = server_.Open({.max_attempts = 2, .max_retry_seconds = 1});
  const auto refused = HasStatus(absl::StatusCode::kResourceExhausted, "too many");
  EXPECT_CALL(server_.jobs, CancelJob)
      .WillOnce(Return(RefusedFor({})))  // as often as it is asked
      .WillOnce(Return(RefusedFor(absl::Seconds(2))));
  for (int i = 0; i < 2; ++i) {
    const absl::Status status = client->jobs().Cancel("j");
    EXPECT_THAT(status, refused);
    EXPECT_EQ(LimitRefusalOf(status)->limit, "--max-streams-per-client");
  }
  EXPECT_CALL(server_.jobs, CancelJob)
      .Times(2)
      .WillRepeatedly(Return(RefusedFor(absl::Milliseconds(1))));
  EXPECT_THAT(client->jobs().Cancel("j"), refused);  // after the last attempt
}

TEST_F(ChannelTest, AServerThatDoesNotAnswerIsTooLate) {
  EXPECT_CALL(server_.models, GetModel).WillOnce([&] {
    over_.WaitForNotification();
    return grpc::Status::OK;
  });
  const auto client = server_.Open({.deadline_seconds = .05});
  EXPECT_EQ(client->models().Get("m").status().code(), absl::StatusCode::kDeadlineExceeded);
  over_.Notify();
}

TEST_F(ChannelTest, AnswersMayBeLargerThanGrpcsDefaultButNotWithoutALimit) {
  const auto client = server_.Connect();
  const auto answer = [](size_t num_bytes) {
    return [num_bytes](grpc::ServerContext*, const v1::GetStreamHeaderRequest*,
                       v1::GetStreamHeaderResponse* response) {
      response->mutable_header()->mutable_box()->set_range(1);
      response->mutable_header()->mutable_box()->set_bits(12);
      response->mutable_header()->set_topology_draco(std::string(num_bytes, 'x'));
      return grpc::Status::OK;
    };
  };
  EXPECT_CALL(server_.poses, GetStreamHeader).WillOnce(answer(5 << 20)).WillOnce(answer(65 << 20));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, client->poses().OpenSession("m", {}));
  EXPECT_EQ(session->header().topology.size(), 5u << 20);
  EXPECT_EQ(client->poses().OpenSession("m", {}).status().code(),
            absl::StatusCode::kResourceExhausted);
}

TEST_F(ChannelTest, APlainServerIsNotTakenForAnEncryptedOne) {
  const auto client = RemoteCharacterService::Connect(server_.address(), {.tls = true});
  EXPECT_THAT(client, HasStatus(absl::StatusCode::kUnavailable,
                                AllOf(HasSubstr(server_.address()), HasSubstr("TLS"),
                                      HasSubstr("an authority of this system"))));
}

TEST_F(ChannelTest, WhereNobodyListensTheMessageSaysWhatToDo) {
  const auto client = RemoteCharacterService::Connect("127.0.0.1:1", {.connect_seconds = .1});
  EXPECT_THAT(client, HasStatus(absl::StatusCode::kUnavailable,
                                AllOf(HasSubstr("'127.0.0.1:1'"), HasSubstr("`pleatd`"),
                                      HasSubstr("does it want --tls?"))));
}

TEST(TransientTest, OnlyErrorsThatMayPassAreTriedAgain) {
  for (int code = 0; code <= 16; ++code) {
    const auto status_code = static_cast<absl::StatusCode>(code);
    EXPECT_EQ(
        IsTransient(absl::Status(status_code, "x")),
        status_code == absl::StatusCode::kUnavailable || status_code == absl::StatusCode::kAborted)
        << code;
  }
}

TEST(BackOffTest, ACancelledWaitEndsAtOnce) {
  EXPECT_FALSE(BackOff(6, Progress({}, [] { return true; })));
  EXPECT_TRUE(BackOff(0, {}));
}

}  // namespace
}  // namespace pleat
