// Pleat over the network: the services of a server.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/remote/live_session.h"
#include "pleat/remote/remote_options.h"
#include "pleat/remote/remote_poses.h"
#include "pleat/service/character_service.h"

namespace grpc {
class Channel;
}

namespace pleat {

struct ServerHealth {
  bool serves = false;     // false: it shuts down
  bool can_store = false;  // uploads and jobs are taken; false: its disk is full or in trouble
};

// Owns the connection and the five services over it. Thread-safe. Errors of the connection are
// kUnavailable, when nobody answers, and kDeadlineExceeded; all others are the server's own.
// Uploads, downloads and watches that break off continue where they stopped.
class RemoteCharacterService final : public CharacterService {
 public:
  // address: HOST:PORT, or unix:PATH. kUnavailable when no server answers in time, with the reason.
  static absl::StatusOr<std::unique_ptr<RemoteCharacterService>> Connect(
      const std::string& address, RemoteOptions options = {});
  // Uses a channel that exists, for servers in this process and for tests.
  static std::unique_ptr<RemoteCharacterService> OverChannel(std::shared_ptr<grpc::Channel> channel,
                                                             RemoteOptions options = {});
  ~RemoteCharacterService() override;

  // What the server says of itself, which needs no token.
  absl::StatusOr<ServerHealth> CheckHealth();

  SequenceService& sequences() override { return *sequences_; }
  JobService& jobs() override { return *jobs_; }
  ModelService& models() override { return *models_; }
  RemotePoses& poses() override { return *poses_; }
  CompressedSequenceService& compressed_sequences() override { return *compressed_sequences_; }

 private:
  explicit RemoteCharacterService(std::unique_ptr<RemoteState> state);

  const std::unique_ptr<RemoteState> state_;  // declared first, because the services use it
  const std::unique_ptr<SequenceService> sequences_;
  const std::unique_ptr<JobService> jobs_;
  const std::unique_ptr<ModelService> models_;
  const std::unique_ptr<RemotePoses> poses_;
  const std::unique_ptr<CompressedSequenceService> compressed_sequences_;
};

}  // namespace pleat
