// A server whose every answer is written down by a test: right, wrong, too early or never.
#pragma once

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "pleat/remote/remote_character_service.h"
#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/model_service.grpc.pb.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/v1/sequence_service.grpc.pb.h"

namespace pleat {

#define PLEAT_SCRIPT_CALL(Name)                                                                  \
  MOCK_METHOD(grpc::Status, Name,                                                                \
              (grpc::ServerContext*, const v1::Name##Request* request, v1::Name##Response* out), \
              (override))
#define PLEAT_SCRIPT_STREAM(Name)                                      \
  MOCK_METHOD(grpc::Status, Name,                                      \
              (grpc::ServerContext*, const v1::Name##Request* request, \
               grpc::ServerWriter<v1::Name##Response>* out),           \
              (override))
#define PLEAT_SCRIPT_UPLOAD(Name)                                                        \
  MOCK_METHOD(grpc::Status, Name,                                                        \
              (grpc::ServerContext*, grpc::ServerReader<v1::UploadSequenceRequest> * in, \
               v1::Name##Response * out),                                                \
              (override))

struct ScriptedSequences : v1::SequenceService::Service {
  PLEAT_SCRIPT_UPLOAD(UploadSequence);
  PLEAT_SCRIPT_CALL(QueryUpload);
  PLEAT_SCRIPT_CALL(GetSequence);
  PLEAT_SCRIPT_CALL(ListSequences);
  PLEAT_SCRIPT_CALL(DeleteSequence);
  PLEAT_SCRIPT_CALL(PinSequence);
  PLEAT_SCRIPT_CALL(DeleteUpload);
};

struct ScriptedJobs : v1::JobService::Service {
  PLEAT_SCRIPT_CALL(CreateTrainingJob);
  PLEAT_SCRIPT_CALL(CreateCompressionJob);
  PLEAT_SCRIPT_CALL(GetJob);
  PLEAT_SCRIPT_CALL(ListJobs);
  PLEAT_SCRIPT_CALL(CancelJob);
  PLEAT_SCRIPT_CALL(DeleteJob);
  PLEAT_SCRIPT_STREAM(WatchJob);
};

struct ScriptedModels : v1::ModelService::Service {
  PLEAT_SCRIPT_CALL(GetModel);
  PLEAT_SCRIPT_CALL(ListModels);
  PLEAT_SCRIPT_CALL(DeleteModel);
  PLEAT_SCRIPT_CALL(PinModel);
  PLEAT_SCRIPT_STREAM(DownloadModel);
};

struct ScriptedCompressed : v1::CompressedSequenceService::Service {
  PLEAT_SCRIPT_CALL(GetCompressedSequence);
  PLEAT_SCRIPT_CALL(ListCompressedSequences);
  PLEAT_SCRIPT_CALL(DeleteCompressedSequence);
  PLEAT_SCRIPT_CALL(PinCompressedSequence);
  PLEAT_SCRIPT_UPLOAD(UploadCompressedSequence);
  PLEAT_SCRIPT_STREAM(DownloadCompressedSequence);
  PLEAT_SCRIPT_STREAM(DecodeFrames);
};

using LiveStream = grpc::ServerReaderWriter<v1::LiveSessionResponse, v1::LiveSessionRequest>;

struct ScriptedPoses : v1::PoseService::Service {
  PLEAT_SCRIPT_CALL(GetStreamHeader);
  PLEAT_SCRIPT_CALL(EvaluatePose);
  PLEAT_SCRIPT_STREAM(EvaluateClip);
  MOCK_METHOD(grpc::Status, LiveSession, (grpc::ServerContext*, LiveStream* stream), (override));
};

#undef PLEAT_SCRIPT_CALL
#undef PLEAT_SCRIPT_STREAM
#undef PLEAT_SCRIPT_UPLOAD

// Calls without a script are UNIMPLEMENTED.
class ScriptedServer {
 public:
  ScriptedServer() {
    testing::DefaultValue<grpc::Status>::SetFactory(
        [] { return grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "not in the script"); });
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    for (grpc::Service* service :
         std::initializer_list<grpc::Service*>{&sequences, &jobs, &models, &compressed, &poses}) {
      builder.RegisterService(service);
    }
    server_ = builder.BuildAndStart();
  }
  ~ScriptedServer() { server_->Shutdown(std::chrono::system_clock::now()); }
  ScriptedServer(const ScriptedServer&) = delete;
  ScriptedServer& operator=(const ScriptedServer&) = delete;

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  // Over a socket, where calls are repeated as the client's channel says.
  std::unique_ptr<RemoteCharacterService> Connect(RemoteOptions options = {}) const {
    return RemoteCharacterService::Connect(address(), std::move(options)).value();
  }
  // Without a network in between: every call is made once.
  std::unique_ptr<RemoteCharacterService> Open(RemoteOptions options = {}) const {
    return RemoteCharacterService::OverChannel(server_->InProcessChannel({}), std::move(options));
  }

  testing::NiceMock<ScriptedSequences> sequences;
  testing::NiceMock<ScriptedJobs> jobs;
  testing::NiceMock<ScriptedModels> models;
  testing::NiceMock<ScriptedCompressed> compressed;
  testing::NiceMock<ScriptedPoses> poses;

 private:
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

inline grpc::Status Unavailable() {
  return grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server restarts");
}
inline grpc::Status Refusal() {
  return grpc::Status(grpc::StatusCode::PERMISSION_DENIED, "not today");
}

}  // namespace pleat
