// One CharacterService, however it is reached: in this process, over an in-process channel, over a
// socket.
#pragma once

#include <spdlog/spdlog.h>

#include <memory>
#include <string>
#include <utility>

#include "pleat/grpc/grpc_server.h"
#include "pleat/local/local_character_service.h"
#include "pleat/remote/remote_character_service.h"
#include "support/fake_training.h"
#include "support/temporary_folder.h"

namespace pleat {

enum class Reach { kLocal, kInProcess, kSocket };

inline std::string ReachName(Reach reach) {
  return reach == Reach::kLocal ? "Local" : reach == Reach::kInProcess ? "InProcess" : "Socket";
}

class RunningService {
 public:
  explicit RunningService(Reach reach, ServiceLimits limits = {}, GrpcServerOptions grpc = {})
      : grpc_(std::move(grpc)) {
    local_ = LocalCharacterService::Open({.data_dir = folder_.path(),
                                          .num_pose_threads = 2,
                                          .limits = limits,
                                          .train = trainer_.function()})
                 .value();
    if (reach == Reach::kLocal) return;
    spdlog::set_level(spdlog::level::err);  // refused requests are what these tests are about
    grpc_.pose_executor = local_->poses().executor();
    server_ = GrpcServer::Start(local_.get(), grpc_).value();
    remote_ = reach == Reach::kInProcess
                  ? RemoteCharacterService::OverChannel(server_->InProcessChannel())
                  : RemoteCharacterService::Connect(address()).value();
  }

  CharacterService& service() {
    return remote_ ? static_cast<CharacterService&>(*remote_) : *local_;
  }
  RemoteCharacterService& remote() { return *remote_; }
  LocalCharacterService& local() { return *local_; }
  GrpcServer& server() { return *server_; }
  const std::string& data_dir() const { return folder_.path(); }
  FakeTrainer& trainer() { return trainer_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(server_->port()); }

  // Ends the server, giving its calls `drain_seconds`, and starts it again at the same port.
  void RestartServer(double drain_seconds) {
    GrpcServerOptions options = grpc_;
    options.listen = address();
    server_->Shutdown(drain_seconds);
    server_ = GrpcServer::Start(local_.get(), options).value();
  }

  std::string TrainModel(const MeshSequence& clip = MakeSwayingTube(5)) {
    const std::string sequence_id = service().sequences().Upload(clip, {})->id;
    const std::string job_id = service().jobs().CreateTraining({.sequence_ids = {sequence_id}})->id;
    std::string model_id;
    const absl::Status status = WatchJob(service().jobs(), job_id, [&](const JobInfo& info) {
      model_id = info.result_id;
      return true;
    });
    return status.ok() ? model_id : status.ToString();
  }

 private:
  GrpcServerOptions grpc_;
  TemporaryFolder folder_;
  FakeTrainer trainer_;
  std::unique_ptr<LocalCharacterService> local_;
  std::unique_ptr<GrpcServer> server_;
  std::unique_ptr<RemoteCharacterService> remote_;
};

}  // namespace pleat
