// Channels, retries and cancellation: how calls go over the network.
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
  kLive,   // small windows, so that an edit does not wait behind frames that nobody has read
};

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address, const RemoteOptions& options,
                                           ChannelUse use);

// Asks the standard health service, which every server has, whether `service` serves; the empty
// name stands for the server itself. The status is that of the call.
grpc::Status AskForHealth(const std::shared_ptr<grpc::Channel>& channel, const std::string& service,
                          bool* serving);

// Waits until the channel is connected, for at most options.connect_seconds. kUnavailable says why
// it is not. When the TLS handshake fails, it returns at once.
absl::Status WaitForConnection(const std::shared_ptr<grpc::Channel>& channel,
                               const std::string& address, const RemoteOptions& options);

absl::Status FromGrpcStatus(const grpc::Status& status);

// Says whether the same call may succeed a little later after this error.
bool IsTransient(const absl::Status& status);
// Sleeps before the next attempt, longer for a larger number of attempts so far, up to 4 s. Returns
// false when `progress` was cancelled meanwhile.
bool BackOff(int attempt, const Progress& progress);

// Cancels the call of `context` as soon as `progress` is cancelled, from a thread of its own.
// `context` must outlive it.
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
