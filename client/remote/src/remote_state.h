// What the remote services share: one connection, its stubs and the options.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "channel.h"
#include "pleat/remote/remote_options.h"
#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/model_service.grpc.pb.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/v1/sequence_service.grpc.pb.h"

namespace pleat {

// The error for a stream of frames whose messages are not what the protocol says.
inline absl::Status BrokenStream(absl::string_view why) {
  return absl::DataLossError(absl::StrCat("the server's stream of frames is wrong: ", why));
}

struct RemoteState {
  std::string address;  // empty when the channel was given
  RemoteOptions options;
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::SequenceService::Stub> sequences;
  std::unique_ptr<v1::JobService::Stub> jobs;
  std::unique_ptr<v1::ModelService::Stub> models;
  std::unique_ptr<v1::CompressedSequenceService::Stub> compressed;
  std::unique_ptr<v1::PoseService::Stub> poses;

  RemoteState(std::string server_address, std::shared_ptr<grpc::Channel> server_channel,
              RemoteOptions remote_options)
      : address(std::move(server_address)),
        options(std::move(remote_options)),
        channel(std::move(server_channel)),
        sequences(v1::SequenceService::NewStub(channel)),
        jobs(v1::JobService::NewStub(channel)),
        models(v1::ModelService::NewStub(channel)),
        compressed(v1::CompressedSequenceService::NewStub(channel)),
        poses(v1::PoseService::NewStub(channel)) {}

  // Makes one call that is no stream, with the deadline of the options for each attempt.
  template <typename Stub, typename Request, typename Response>
  absl::Status Call(Stub* stub,
                    grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                    const Request& request, Response* response) const {
    return RetryRefused(options, [&] {
      grpc::ClientContext context;
      context.set_deadline(
          std::chrono::system_clock::now() +
          std::chrono::milliseconds(static_cast<int64_t>(options.deadline_seconds * 1000)));
      return FromGrpcStatus((stub->*method)(&context, request, response));
    });
  }
};

}  // namespace pleat
