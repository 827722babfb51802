// The server itself over mocks of the services: addresses, certificates, and how it shuts down.
#include "pleat/grpc/grpc_server.h"

#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include <thread>

#include "pleat/base/file.h"
#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/model_service.grpc.pb.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/v1/sequence_service.grpc.pb.h"
#include "server/handlers/mock_server.h"
#include "support/checkpoint.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

// Longer than any test: a shutdown that ends earlier has not waited for it.
constexpr double kLongDrainSeconds = 600;

class GrpcServerTest : public testing::Test {
 protected:
  grpc::Status DeleteModel() {
    grpc::ClientContext context;
    v1::DeleteModelRequest request;
    v1::DeleteModelResponse response;
    request.set_id(kId);
    return v1::ModelService::NewStub(mock_.channel)->DeleteModel(&context, request, &response);
  }
  // A call that the service holds until the test lets it go.
  void ExpectHeldDelete() {
    EXPECT_CALL(mock_.service.mock_models, Delete(kId)).WillOnce([this](const std::string&) {
      in_delete_.Pass();
      return absl::OkStatus();
    });
  }

  Checkpoint in_delete_;
  MockServer mock_;
};

TEST_F(GrpcServerTest, AnAddressThatIsTakenIsRefused) {
  MockService service;
  const auto first = GrpcServer::Start(&service, {}).value();
  ASSERT_GT(first->port(), 0);
  for (const std::string& address :
       {"127.0.0.1:" + std::to_string(first->port()), std::string("unix:/no/such/folder/socket")}) {
    EXPECT_THAT(GrpcServer::Start(&service, {.listen = address}),
                HasStatus(absl::StatusCode::kUnavailable, HasSubstr(address)));
  }
}

TEST_F(GrpcServerTest, CertificatesThatDoNotFitAreRefused) {
  MockService service;
  for (const GrpcServerOptions& half :
       {GrpcServerOptions{.tls = {.certificate = "c"}}, GrpcServerOptions{.tls = {.key = "k"}},
        GrpcServerOptions{.tls = {.client_ca = "ca"}}}) {
    EXPECT_THAT(GrpcServer::Start(&service, half),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("certificate")));
  }
  EXPECT_THAT(GrpcServer::Start(&service, {.tls = {.certificate = "/no/such/file", .key = "k"}}),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("/no/such/file")));
  TemporaryFolder folder;
  const std::string path = folder.path() + "/file";
  ASSERT_THAT(WriteFile(path, "no PEM"), IsOk());
  EXPECT_THAT(GrpcServer::Start(&service, {.tls = {.certificate = path, .key = path}}),
              HasStatus(absl::StatusCode::kUnavailable, HasSubstr("no PEM certificate")));
}

TEST_F(GrpcServerTest, AnIdleServerShutsDownAtOnceAndOnlyOnce) {
  mock_.server->Shutdown(kLongDrainSeconds);
  mock_.server->Shutdown(kLongDrainSeconds);
}

TEST_F(GrpcServerTest, ShutdownWaitsForTheCallUnderWayAndNotForItsDeadline) {
  ExpectHeldDelete();
  grpc::Status status;
  std::thread client([&] { status = DeleteModel(); });
  in_delete_.WaitUntilReached();
  std::thread stopper([&] { mock_.server->Shutdown(kLongDrainSeconds); });
  // Calls that come now are refused, the first of them at the latest when the server drains.
  EXPECT_CALL(mock_.service.mock_models, Get).WillRepeatedly([](const std::string&) {
    return absl::NotFoundError("none");
  });
  grpc::StatusCode code = grpc::StatusCode::NOT_FOUND;
  while (code == grpc::StatusCode::NOT_FOUND) {
    grpc::ClientContext context;
    v1::GetModelRequest request;
    v1::GetModelResponse response;
    request.set_id(kId);
    code = v1::ModelService::NewStub(mock_.channel)
               ->GetModel(&context, request, &response)
               .error_code();
  }
  EXPECT_EQ(code, grpc::StatusCode::UNAVAILABLE);
  in_delete_.Release();
  stopper.join();
  client.join();
  EXPECT_TRUE(status.ok()) << status.error_message();
}

TEST_F(GrpcServerTest, TheDrainDeadlineCancelsWhatIsLeft) {
  // An upload whose client sends nothing, and a watch of a job that never changes.
  EXPECT_CALL(mock_.service.mock_jobs, Subscribe("job-1", _)).WillOnce([](auto&&...) {
    auto subscription = std::make_unique<testing::NiceMock<MockJobSubscription>>();
    ON_CALL(*subscription, current).WillByDefault([] { return JobUpdate{{}, 1}; });
    return subscription;
  });
  grpc::ClientContext upload_context;
  v1::UploadSequenceResponse uploaded;
  const auto upload =
      v1::SequenceService::NewStub(mock_.channel)->UploadSequence(&upload_context, &uploaded);
  v1::WatchJobRequest request;
  request.set_id("job-1");
  const auto watch = v1::JobService::NewStub(mock_.channel)->WatchJob(&mock_.call, request);
  v1::WatchJobResponse response;
  ASSERT_TRUE(watch->Read(&response));
  mock_.server->Shutdown(0);
  EXPECT_FALSE(watch->Read(&response));
  EXPECT_FALSE(watch->Finish().ok());
  EXPECT_FALSE(upload->Finish().ok());
}

TEST_F(GrpcServerTest, LiveSessionsEndAtOnceSoThatTheirClientsCanGoOnElsewhere) {
  const auto session = v1::PoseService::NewStub(mock_.channel)->LiveSession(&mock_.call);
  ExpectHeldDelete();
  std::thread client([&] { DeleteModel(); });
  in_delete_.WaitUntilReached();
  std::thread stopper([&] { mock_.server->Shutdown(kLongDrainSeconds); });
  // The session ends although another call goes on.
  v1::LiveSessionResponse response;
  EXPECT_FALSE(session->Read(&response));
  EXPECT_THAT(session->Finish(), HasGrpcStatus(grpc::StatusCode::UNAVAILABLE, HasSubstr("shut")));
  in_delete_.Release();
  stopper.join();
  client.join();
}

TEST_F(GrpcServerTest, AClientThatIsGoneDoesNotHoldUpTheShutdown) {
  ExpectHeldDelete();
  v1::DeleteModelRequest request;
  v1::DeleteModelResponse response;
  request.set_id(kId);
  std::thread client([&] {
    const grpc::Status status =
        v1::ModelService::NewStub(mock_.channel)->DeleteModel(&mock_.call, request, &response);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::CANCELLED);
  });
  in_delete_.WaitUntilReached();
  mock_.call.TryCancel();
  client.join();  // the client is gone, its call is still under way
  std::thread stopper([&] { mock_.server->Shutdown(kLongDrainSeconds); });
  in_delete_.Release();
  stopper.join();
}

// A watch that would stay open for ever ends soon after the age and the grace of its connection.
TEST_F(GrpcServerTest, AnOldConnectionEndsWithItsCalls) {
  MockService service;
  EXPECT_CALL(service.mock_jobs, Subscribe).WillRepeatedly([](auto&&...) {
    auto subscription = std::make_unique<testing::NiceMock<MockJobSubscription>>();
    ON_CALL(*subscription, current).WillByDefault([] { return JobUpdate{{}, 1}; });
    return subscription;
  });
  const auto server =
      GrpcServer::Start(&service,
                        {.connections = {.max_age_seconds = .2, .max_age_grace_seconds = .1}})
          .value();
  const auto channel = grpc::CreateChannel("127.0.0.1:" + std::to_string(server->port()),
                                           grpc::InsecureChannelCredentials());
  v1::WatchJobRequest request;
  request.set_id("job-1");
  for (int round = 0; round < 2; ++round) {  // a client simply connects again
    grpc::ClientContext context;
    const auto watch = v1::JobService::NewStub(channel)->WatchJob(&context, request);
    v1::WatchJobResponse update;
    EXPECT_TRUE(watch->Read(&update));
    EXPECT_FALSE(watch->Read(&update));  // returns when the server has ended the connection
    EXPECT_FALSE(watch->Finish().ok());
  }
}

}  // namespace
}  // namespace pleat
