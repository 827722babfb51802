// Channels and contexts: how calls go over the network.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "pleat/base/progress.h"
#include "pleat/remote/remote_options.h"

namespace pleat {

enum class ChannelUse {
  kCalls,  // everything with a known end
  kLive,   // small windows: an edited pose must not queue behind frames that nobody has read
};

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address, const RemoteOptions& options,
                                           ChannelUse use);

// Waits until the channel is connected, at most so long. kUnavailable says why it is not; that both
// sides do not agree on encryption is said at once.
absl::Status WaitForConnection(const std::shared_ptr<grpc::Channel>& channel,
                               const std::string& address, const RemoteOptions& options);

absl::Status FromGrpcStatus(const grpc::Status& status);

// True for errors after which the same call may succeed a little later.
bool IsTransient(const absl::Status& status);
// Sleeps before attempt `attempt` (1, 2, ...); false when `progress` was cancelled meanwhile.
bool BackOff(int attempt, const Progress& progress);

// Cancels the call of `context` as soon as `progress` is cancelled.
class CancelWatcher {
 public:
  CancelWatcher(grpc::ClientContext* context, const Progress& progress);
  ~CancelWatcher();
  CancelWatcher(const CancelWatcher&) = delete;
  CancelWatcher& operator=(const CancelWatcher&) = delete;

 private:
  std::atomic<bool> done_ = false;
  std::thread thread_;
};

}  // namespace pleat
