// What the parts of the remote service share.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "channel.h"
#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/model_service.grpc.pb.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/v1/sequence_service.grpc.pb.h"

namespace pleat {

struct RemoteCharacterService::State {
  std::string address;  // empty over a given channel
  RemoteOptions options;
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::SequenceService::Stub> sequences;
  std::unique_ptr<v1::JobService::Stub> jobs;
  std::unique_ptr<v1::ModelService::Stub> models;
  std::unique_ptr<v1::CompressedSequenceService::Stub> compressed;
  std::unique_ptr<v1::PoseService::Stub> poses;

  // The model downloaded last, for streams of parameters.
  std::mutex model_mutex;
  std::string model_id;                         // guarded by model_mutex
  std::shared_ptr<const CharacterModel> model;  // guarded by model_mutex
  absl::StatusOr<std::shared_ptr<const CharacterModel>> Model(RemoteCharacterService* service,
                                                              const std::string& id);

  State(std::string server_address, std::shared_ptr<grpc::Channel> server_channel,
        RemoteOptions remote_options)
      : address(std::move(server_address)),
        options(std::move(remote_options)),
        channel(std::move(server_channel)),
        sequences(v1::SequenceService::NewStub(channel)),
        jobs(v1::JobService::NewStub(channel)),
        models(v1::ModelService::NewStub(channel)),
        compressed(v1::CompressedSequenceService::NewStub(channel)),
        poses(v1::PoseService::NewStub(channel)) {}

  void SetDeadline(grpc::ClientContext* context) const {
    context->set_deadline(
        std::chrono::system_clock::now() +
        std::chrono::milliseconds(static_cast<int64_t>(options.deadline_seconds * 1000)));
  }

  // Uploads and downloads in chunks; both go on where a broken call stopped (remote_transfer.cpp).
  // start: opens the stream. The bytes of a download have the SHA-256 `id`.
  template <typename Response>
  absl::StatusOr<Response> Upload(
      const std::string& id, const std::string& bytes, const Progress& progress,
      const std::function<std::unique_ptr<grpc::ClientWriter<v1::UploadSequenceRequest>>(
          grpc::ClientContext*, Response*)>& start) const;
  template <typename Request, typename Response>
  absl::StatusOr<std::string> Download(
      const std::string& id, const Progress& progress,
      const std::function<std::unique_ptr<grpc::ClientReader<Response>>(
          grpc::ClientContext*, const Request&)>& start) const;

  // Makes one unary call.
  template <typename Stub, typename Request, typename Response>
  absl::Status Call(Stub* stub,
                    grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                    const Request& request, Response* response) const {
    grpc::ClientContext context;
    SetDeadline(&context);
    return FromGrpcStatus((stub->*method)(&context, request, response));
  }
};

}  // namespace pleat
