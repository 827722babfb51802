// Tokens in front of a whole server over mocks: who is let in, and who has to leave.
#include "pleat/reactors/admission.h"

#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include <set>

#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/model_service.grpc.pb.h"
#include "pleat/v1/sequence_service.grpc.pb.h"
#include "server/handlers/mock_server.h"
#include "support/token_files.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

class AdmissionTest : public testing::Test {
 protected:
  grpc::Status Delete(const std::string& authorization) { return Delete(authorization, mock_); }
  static grpc::Status Delete(const std::string& authorization, MockServer& server) {
    grpc::ClientContext context;
    if (!authorization.empty()) context.AddMetadata("authorization", authorization);
    v1::DeleteModelRequest request;
    v1::DeleteModelResponse response;
    request.set_id(kId);
    return v1::ModelService::NewStub(server.channel)->DeleteModel(&context, request, &response);
  }
  // Jobs that never change: a watch of one gives its state once and stays open.
  static void ExpectEndlessJobs(MockJobService* jobs) {
    EXPECT_CALL(*jobs, Subscribe).WillRepeatedly([](auto&&...) {
      auto subscription = std::make_unique<testing::NiceMock<MockJobSubscription>>();
      ON_CALL(*subscription, current).WillByDefault([] { return JobUpdate{{}, 1}; });
      return subscription;
    });
  }
  void ExpectDeletes(int count) {
    EXPECT_CALL(mock_.service.mock_models, Delete(kId))
        .Times(count)
        .WillRepeatedly(testing::Return(absl::OkStatus()));
  }

  TestTokens tokens_;
  MockService server_of_default_;
  MockServer mock_{{.tokens = tokens_.registry()}};
};

TEST_F(AdmissionTest, WithoutTokensEverybodyMayDoEverything) {
  ExpectDeletes(2);
  EXPECT_TRUE(Delete("").ok());
  EXPECT_TRUE(Delete("Bearer nonsense").ok());
}

TEST_F(AdmissionTest, AsSoonAsThereIsATokenEachCallNeedsOne) {
  const NewToken admin = tokens_.Add("Ada", "read,admin");
  const NewToken reader = tokens_.Add("Rea", "read,pose,train");
  ExpectDeletes(2);
  EXPECT_TRUE(Delete("Bearer " + admin.text).ok());
  EXPECT_TRUE(Delete("bearer " + admin.text).ok()) << "the scheme is not case-sensitive";
  EXPECT_THAT(Delete(""), HasGrpcStatus(grpc::StatusCode::UNAUTHENTICATED, HasSubstr("token")));
  EXPECT_THAT(Delete("Bearer " + admin.text.substr(1)),
              HasGrpcStatus(grpc::StatusCode::UNAUTHENTICATED, HasSubstr("token")));
  EXPECT_THAT(Delete("Basic " + admin.text),
              HasGrpcStatus(grpc::StatusCode::UNAUTHENTICATED, HasSubstr("token")));
  EXPECT_THAT(Delete("Bearer " + reader.text),
              HasGrpcStatus(grpc::StatusCode::PERMISSION_DENIED,
                            HasSubstr("'Rea' allows read,pose,train; DeleteModel needs admin")));
}

// The token alone decides what a call sees, unary or stream.
TEST_F(AdmissionTest, ACallGetsTheServicesOfItsProject) {
  MockService robots;
  std::vector<std::string> asked;
  MockServer server({.tokens = tokens_.registry(), .of_project = [&](const std::string& project) {
                       asked.push_back(project);
                       return project == "robots" ? &robots : &server_of_default_;
                     }});
  const NewToken robot = tokens_.Add("R2", "read,admin", "robots");
  const NewToken other = tokens_.Add("Rea", "read,admin");
  EXPECT_CALL(robots.mock_models, Delete(kId)).Times(2).WillRepeatedly([](auto&&...) {
    return absl::OkStatus();
  });
  EXPECT_CALL(server_of_default_.mock_models, Delete(kId))
      .WillOnce(testing::Return(absl::NotFoundError("no model")));
  EXPECT_CALL(robots.mock_jobs, Subscribe).WillOnce([](auto&&...) {
    return absl::NotFoundError("no job of robots");
  });
  EXPECT_CALL(server_of_default_.mock_jobs, Subscribe).Times(0);
  EXPECT_TRUE(Delete("Bearer " + robot.text, server).ok());
  EXPECT_TRUE(Delete("Bearer " + robot.text, server).ok());
  EXPECT_THAT(Delete("Bearer " + other.text, server),
              HasGrpcStatus(grpc::StatusCode::NOT_FOUND, _));
  EXPECT_THAT(asked, testing::ElementsAre("robots", kDefaultProject)) << "once for each";
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer " + robot.text);
  v1::WatchJobRequest request;
  request.set_id("job-1");
  const auto watch = v1::JobService::NewStub(server.channel)->WatchJob(&context, request);
  v1::WatchJobResponse update;
  EXPECT_FALSE(watch->Read(&update));
  EXPECT_THAT(watch->Finish(), HasGrpcStatus(grpc::StatusCode::NOT_FOUND, HasSubstr("robots")));
}

TEST_F(AdmissionTest, StreamsAreRefusedAsWell) {
  const NewToken reader = tokens_.Add("Rea", "read");
  mock_.call.AddMetadata("authorization", "Bearer " + reader.text);
  v1::UploadSequenceResponse response;
  const auto upload =
      v1::SequenceService::NewStub(mock_.channel)->UploadSequence(&mock_.call, &response);
  EXPECT_THAT(upload->Finish(),
              HasGrpcStatus(grpc::StatusCode::PERMISSION_DENIED, HasSubstr("needs train")));
  grpc::ClientContext context;
  const auto watch =
      v1::JobService::NewStub(mock_.channel)->WatchJob(&context, v1::WatchJobRequest());
  v1::WatchJobResponse update;
  EXPECT_FALSE(watch->Read(&update));
  EXPECT_THAT(watch->Finish(), HasGrpcStatus(grpc::StatusCode::UNAUTHENTICATED, _));
}

TEST_F(AdmissionTest, ACallUnderWayEndsWhenItsTokenIsRevoked) {
  const NewToken reader = tokens_.Add("Rea", "read"), other = tokens_.Add("Otto", "read");
  ExpectEndlessJobs(&mock_.service.mock_jobs);
  const auto stub = v1::JobService::NewStub(mock_.channel);
  v1::WatchJobRequest request;
  request.set_id("job-1");
  grpc::ClientContext other_context;
  other_context.AddMetadata("authorization", "Bearer " + other.text);
  mock_.call.AddMetadata("authorization", "Bearer " + reader.text);
  const auto watch = stub->WatchJob(&mock_.call, request);
  const auto other_watch = stub->WatchJob(&other_context, request);
  v1::WatchJobResponse update;
  ASSERT_TRUE(watch->Read(&update));
  ASSERT_TRUE(other_watch->Read(&update));
  tokens_.Revoke(reader.token.id);
  EXPECT_FALSE(watch->Read(&update));  // returns when the server has cancelled the call
  EXPECT_FALSE(watch->Finish().ok());
  tokens_.Revoke(other.token.id);
  EXPECT_FALSE(other_watch->Read(&update));
  EXPECT_FALSE(other_watch->Finish().ok());
}

TEST_F(AdmissionTest, OneClientCannotHaveAllStreams) {
  MockServer server({.tokens = tokens_.registry(), .max_streams_per_client = 2});
  ExpectEndlessJobs(&server.service.mock_jobs);
  const NewToken one = tokens_.Add("one", "read"), other = tokens_.Add("other", "read");
  const auto stub = v1::JobService::NewStub(server.channel);
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  const auto watch = [&](const NewToken& token) {
    contexts.push_back(std::make_unique<grpc::ClientContext>());
    contexts.back()->AddMetadata("authorization", "Bearer " + token.text);
    return stub->WatchJob(contexts.back().get(), v1::WatchJobRequest());
  };
  v1::WatchJobResponse update;
  const auto first = watch(one), second = watch(one);
  ASSERT_TRUE(first->Read(&update));
  ASSERT_TRUE(second->Read(&update));
  const auto third = watch(one);
  EXPECT_FALSE(third->Read(&update));
  EXPECT_THAT(third->Finish(), HasGrpcStatus(grpc::StatusCode::RESOURCE_EXHAUSTED,
                                             HasSubstr("--max-streams-per-client")));
  const auto foreign = watch(other);
  EXPECT_TRUE(foreign->Read(&update));
  server.server->Shutdown(0);
  for (const auto* open : {&first, &second, &foreign}) EXPECT_FALSE((*open)->Finish().ok());
}

TEST(RpcRuleTest, EveryRpcHasExactlyOneRule) {
  const google::protobuf::DescriptorPool& pool =
      *google::protobuf::DescriptorPool::generated_pool();
  std::set<std::string> names;
  for (const char* file : {"sequence_service", "job_service", "model_service", "pose_service",
                           "compressed_sequence_service"}) {
    const auto* descriptor = pool.FindFileByName(std::string("pleat/v1/") + file + ".proto");
    ASSERT_NE(descriptor, nullptr) << file;
    for (int s = 0; s < descriptor->service_count(); ++s) {
      for (int m = 0; m < descriptor->service(s)->method_count(); ++m) {
        const std::string& name = descriptor->service(s)->method(m)->name();
        EXPECT_TRUE(names.insert(name).second) << name << " stands in two services";
        const RpcRule* rule = FindRpcRule(name);
        ASSERT_NE(rule, nullptr) << name;
        // What decides how long content lives is for administrators; whoever uploads may give up.
        // What changes something is in the audit log.
        EXPECT_EQ(rule->scope == Scope::kAdmin,
                  (name.starts_with("Delete") || name.starts_with("Pin")) && name != "DeleteUpload")
            << name;
        if (name.starts_with("Delete") || name.starts_with("Pin") || name.starts_with("Create") ||
            name.starts_with("Upload") || name.starts_with("Download")) {
          EXPECT_TRUE(rule->audited) << name;
        }
      }
    }
  }
  EXPECT_GE(names.size(), 25);
  EXPECT_EQ(FindRpcRule("Check"), nullptr);
}

TEST_F(AdmissionTest, TheHealthCheckNeedsNoToken) {
  tokens_.Add("Ada", "admin");
  grpc::GenericStub stub(mock_.channel);
  grpc::CompletionQueue queue;
  const grpc::Slice nothing("");
  grpc::ByteBuffer request(&nothing, 1), response;
  grpc::Status status;
  const auto call =
      stub.PrepareUnaryCall(&mock_.call, "/grpc.health.v1.Health/Check", request, &queue);
  call->StartCall();
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  EXPECT_TRUE(status.ok()) << status.error_message();
}

}  // namespace
}  // namespace pleat
