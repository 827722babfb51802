#include "pleat/remote/remote_character_service.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "channel.h"
#include "pleat/base/address.h"
#include "pleat/base/status.h"
#include "pleat/identity/token.h"
#include "remote_services.h"
#include "remote_state.h"

namespace pleat {
namespace {

// As in server/grpc/src/health_watch.h.
constexpr char kReadyName[] = "pleat.ready";

absl::Status CheckToken(const std::string& address, const RemoteOptions& options) {
  if (options.token.empty()) return absl::OkStatus();
  if (!ParseTokenText(options.token)) {
    return absl::InvalidArgumentError(
        "the token has another form than pleat_ID_SECRET; copy it whole, as 'pleat token create' "
        "printed it");
  }
  if (options.tls || IsLocalAddress(address)) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      "the token would go to '", address, "' in plain text, where others can read it; use TLS"));
}

}  // namespace

absl::StatusOr<std::unique_ptr<RemoteCharacterService>> RemoteCharacterService::Connect(
    const std::string& address, RemoteOptions options) {
  PLEAT_RETURN_IF_ERROR(CheckToken(address, options));
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

absl::StatusOr<ServerHealth> RemoteCharacterService::CheckHealth() {
  ServerHealth health;
  PLEAT_RETURN_IF_ERROR(FromGrpcStatus(AskForHealth(state_->channel, "", &health.serves)));
  const absl::Status ready =
      FromGrpcStatus(AskForHealth(state_->channel, kReadyName, &health.can_store));
  if (absl::IsNotFound(ready)) health.can_store = health.serves;  // a server before 0.2
  return health;
}

}  // namespace pleat
