#include "pleat/remote/remote_character_service.h"

#include <utility>

#include "channel.h"
#include "pleat/base/status.h"
#include "remote_services.h"
#include "remote_state.h"

namespace pleat {

absl::StatusOr<std::unique_ptr<RemoteCharacterService>> RemoteCharacterService::Connect(
    const std::string& address, RemoteOptions options) {
  std::shared_ptr<grpc::Channel> channel = MakeChannel(address, options, ChannelUse::kCalls);
  PLEAT_RETURN_IF_ERROR(WaitForConnection(channel, address, options));
  return std::unique_ptr<RemoteCharacterService>(new RemoteCharacterService(
      std::make_unique<RemoteState>(address, std::move(channel), std::move(options))));
}

std::unique_ptr<RemoteCharacterService> RemoteCharacterService::OverChannel(
    std::shared_ptr<grpc::Channel> channel, RemoteOptions options) {
  return std::unique_ptr<RemoteCharacterService>(new RemoteCharacterService(
      std::make_unique<RemoteState>(std::string(), std::move(channel), std::move(options))));
}

RemoteCharacterService::RemoteCharacterService(std::unique_ptr<RemoteState> state)
    : state_(std::move(state)),
      sequences_(MakeRemoteSequences(state_.get())),
      jobs_(MakeRemoteJobs(state_.get())),
      models_(MakeRemoteModels(state_.get())),
      poses_(std::make_unique<RemotePoses>(state_.get(), models_.get())),
      compressed_sequences_(MakeRemoteCompressedSequences(state_.get())) {}

RemoteCharacterService::~RemoteCharacterService() = default;

}  // namespace pleat
