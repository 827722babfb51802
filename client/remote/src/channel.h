// Channels, retries and cancellation: how calls go over the network.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
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

// With the limit that refused the call, when the server named one (limit_refusal.h).
absl::Status FromGrpcStatus(const grpc::Status& status);

// How long the server asks to wait before the same call; nothing when it says no such thing.
std::optional<absl::Duration> RetryDelayOf(const absl::Status& status);
// Waits as long as the server asked for, and at least as long as BackOff. Returns false, without
// waiting, when it asked for nothing or for too much, or when this was the last attempt.
bool WaitForRetry(const absl::Status& status, int attempt, const RemoteOptions& options,
                  const Progress& progress = {});

inline const absl::Status& StatusOf(const absl::Status& status) { return status; }
template <typename T>
const absl::Status& StatusOf(const absl::StatusOr<T>& result) {
  return result.status();
}
// Makes a call, and makes it again after the time that the server asked for when it was refused for
// a limit: then the server has done nothing.
template <typename Make>
auto RetryRefused(const RemoteOptions& options, Make make) -> decltype(make()) {
  for (int attempt = 1;; ++attempt) {
    auto result = make();
    if (!WaitForRetry(StatusOf(result), attempt, options)) return result;
  }
}

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
