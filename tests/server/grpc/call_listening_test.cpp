#include "call_listening.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/base/limit_refusal.h"
#include "pleat/observe/request_scope.h"
#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/model_service.grpc.pb.h"
#include "server/handlers/mock_server.h"
#include "support/token_files.h"

namespace pleat {
namespace {

// What a listener has heard, from any thread.
class Heard {
 public:
  struct End {
    CallFacts facts;
    int status;
  };

  const CallListener* listener() const { return &listener_; }
  End WaitForEnd() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !ends_.empty(); });
    End end = ends_.front();
    ends_.erase(ends_.begin());
    return end;
  }
  int num_started() {
    std::lock_guard lock(mutex_);
    return num_started_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int num_started_ = 0;
  std::vector<End> ends_;
  const CallListener listener_{[this](const std::string&) {
                                 std::lock_guard lock(mutex_);
                                 ++num_started_;
                               },
                               [this](const CallFacts& facts, int status, double seconds) {
                                 EXPECT_GE(seconds, 0);
                                 std::lock_guard lock(mutex_);
                                 ends_.push_back({facts, status});
                                 changed_.notify_all();
                               }};
};

class CallListeningTest : public testing::Test {
 protected:
  Heard heard_;
  MockServer mock_{{.call_listener = heard_.listener()}};
};

// What the handler logs and what the listener hears name the same request.
TEST_F(CallListeningTest, ACallHasOneRequestIdFromBeginToEnd) {
  std::vector<std::string> in_handler;
  EXPECT_CALL(mock_.service.mock_models, Delete(kId)).Times(2).WillRepeatedly([&](auto&&...) {
    in_handler.push_back(CurrentRequestId());
    return absl::OkStatus();
  });
  v1::DeleteModelRequest request;
  v1::DeleteModelResponse response;
  request.set_id(kId);
  const auto stub = v1::ModelService::NewStub(mock_.channel);
  mock_.call.AddMetadata("x-request-id", "shot-7");
  EXPECT_TRUE(stub->DeleteModel(&mock_.call, request, &response).ok());
  EXPECT_EQ(heard_.WaitForEnd().facts.request_id, "shot-7");
  grpc::ClientContext other;
  EXPECT_TRUE(stub->DeleteModel(&other, request, &response).ok());
  const std::string made = heard_.WaitForEnd().facts.request_id;
  EXPECT_EQ(made.size(), 16u);
  EXPECT_EQ(in_handler, (std::vector<std::string>{"shot-7", made}));
}

TEST_F(CallListeningTest, AnAuditedCallTellsWhatItIsAbout) {
  const NewToken made = MakeToken("Ada", ScopeSet::All(), 0, {});
  EXPECT_CALL(mock_.service.mock_models, Delete(kId))
      .WillOnce(testing::Return(absl::NotFoundError("none")));
  mock_.call.AddMetadata("authorization", "Bearer " + made.text);
  v1::DeleteModelRequest request;
  v1::DeleteModelResponse response;
  request.set_id(kId);
  EXPECT_FALSE(
      v1::ModelService::NewStub(mock_.channel)->DeleteModel(&mock_.call, request, &response).ok());
  const Heard::End end = heard_.WaitForEnd();
  EXPECT_EQ(heard_.num_started(), 1);
  EXPECT_EQ(end.facts.method, "/pleat.v1.ModelService/DeleteModel");
  EXPECT_EQ(end.status, grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(end.facts.token_id, made.token.id);
  EXPECT_TRUE(end.facts.audited);
  EXPECT_EQ(end.facts.ids, std::vector<std::string>{kId});
  EXPECT_FALSE(end.facts.peer.empty());
}

TEST_F(CallListeningTest, ACallTellsItsProjectOnceItWasLetIn) {
  TestTokens tokens;
  const NewToken robot = tokens.Add("R2", "read", "robots");
  std::vector<std::string> in_handler;
  MockServer server({.call_listener = heard_.listener(),
                     .tokens = tokens.registry(),
                     .of_project = [&](auto&&) { return &mock_.service; }});
  EXPECT_CALL(mock_.service.mock_models, Get(kId)).WillOnce([&](auto&&...) {
    in_handler.push_back(CurrentRequest().project);
    return absl::NotFoundError("none");
  });
  EXPECT_CALL(mock_.service.mock_jobs, Subscribe).WillOnce([&](auto&&...) {
    in_handler.push_back(CurrentRequest().project);
    return absl::NotFoundError("none");
  });
  v1::GetModelRequest request;
  v1::GetModelResponse response;
  request.set_id(kId);
  const auto models = v1::ModelService::NewStub(server.channel);
  grpc::ClientContext known, unknown, watching;
  known.AddMetadata("authorization", "Bearer " + robot.text);
  EXPECT_FALSE(models->GetModel(&known, request, &response).ok());
  EXPECT_EQ(heard_.WaitForEnd().facts.project, "robots");
  // Whoever shows the id of a token and not its secret is nobody.
  unknown.AddMetadata("authorization",
                      "Bearer pleat_" + robot.token.id + "_" + std::string(64, '0'));
  EXPECT_FALSE(models->GetModel(&unknown, request, &response).ok());
  EXPECT_EQ(heard_.WaitForEnd().facts.project, "");
  watching.AddMetadata("authorization", "Bearer " + robot.text);
  const auto watch =
      v1::JobService::NewStub(server.channel)->WatchJob(&watching, v1::WatchJobRequest());
  v1::WatchJobResponse update;
  EXPECT_FALSE(watch->Read(&update));
  EXPECT_FALSE(watch->Finish().ok());
  EXPECT_EQ(heard_.WaitForEnd().facts.project, "robots");
  EXPECT_THAT(in_handler, testing::ElementsAre("robots", "robots"));
}

TEST_F(CallListeningTest, ARefusedCallTellsTheLimit) {
  EXPECT_CALL(mock_.service.mock_models, Get(kId))
      .WillOnce(testing::Return(RefuseForLimit({.limit = "--request-bytes"}, "too much")))
      .WillOnce(testing::Return(absl::ResourceExhaustedError("for another reason")));
  v1::GetModelRequest request;
  v1::GetModelResponse response;
  request.set_id(kId);
  const auto stub = v1::ModelService::NewStub(mock_.channel);
  for (const char* limit : {"--request-bytes", ""}) {
    grpc::ClientContext context;
    EXPECT_FALSE(stub->GetModel(&context, request, &response).ok());
    EXPECT_EQ(heard_.WaitForEnd().facts.limit, limit);
  }
}

TEST_F(CallListeningTest, AnUnauditedCallTellsNoIds) {
  EXPECT_CALL(mock_.service.mock_models, Get(kId))
      .WillOnce(testing::Return(absl::NotFoundError("none")));
  v1::GetModelRequest request;
  v1::GetModelResponse response;
  request.set_id(kId);
  EXPECT_FALSE(
      v1::ModelService::NewStub(mock_.channel)->GetModel(&mock_.call, request, &response).ok());
  const Heard::End end = heard_.WaitForEnd();
  EXPECT_FALSE(end.facts.audited);
  EXPECT_TRUE(end.facts.ids.empty());
  EXPECT_TRUE(end.facts.token_id.empty());
}

}  // namespace
}  // namespace pleat
