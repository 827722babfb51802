// A server over mocks, for the handlers of streams, which need a call.
#pragma once

#include <grpcpp/grpcpp.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "pleat/grpc/grpc_server.h"
#include "server/handlers/handler_checks.h"

namespace pleat {

struct MockService final : CharacterService {
  testing::StrictMock<MockSequenceService> mock_sequences;
  testing::StrictMock<MockJobService> mock_jobs;
  testing::StrictMock<MockModelService> mock_models;
  testing::StrictMock<MockPoseService> mock_poses;
  testing::StrictMock<MockCompressedSequenceService> mock_compressed_sequences;

  SequenceService& sequences() override { return mock_sequences; }
  JobService& jobs() override { return mock_jobs; }
  ModelService& models() override { return mock_models; }
  PoseService& poses() override { return mock_poses; }
  CompressedSequenceService& compressed_sequences() override { return mock_compressed_sequences; }
};

// The mocks behind a channel without network. Set expectations before the call.
struct MockServer {
  explicit MockServer(const GrpcServerOptions& options = {})
      : server(GrpcServer::Start(&service, options).value()) {
    spdlog::set_level(spdlog::level::err);  // refusals are what is tested
  }

  MockService service;
  const std::unique_ptr<GrpcServer> server;
  const std::shared_ptr<grpc::Channel> channel = server->InProcessChannel();
  grpc::ClientContext call;
};

MATCHER_P2(HasGrpcStatus, code, message_matcher, "") {
  *result_listener << "whose code is " << arg.error_code() << ": " << arg.error_message();
  return arg.error_code() == code &&
         testing::ExplainMatchResult(message_matcher, arg.error_message(), result_listener);
}

}  // namespace pleat
