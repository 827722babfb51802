// Puts load on a server, by many live sessions at a fixed rate, and measures how long every frame
// took.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/remote/live_session.h"
#include "pleat/remote/remote_poses.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

enum class Arrivals {
  kFixed,    // open loop: poses at equal distances, whatever the server does
  kPoisson,  // open loop: the same rate at random times
  kClosed,   // closed loop: the next pose after the frame of the last one; finds the throughput
};

struct LoadOptions {
  int num_clients = 1;
  double rate_fps = 30;  // the rate of each client; kClosed does not use it
  double seconds = 10;
  Arrivals arrivals = Arrivals::kFixed;
  uint64_t seed = 1;
  LiveSessionOptions session{.decode = false};
};

struct LoadSample {
  double sent_s = 0;  // when the pose should have been sent, in seconds since the start
  // The time from then to the frame. A sender that is late counts against the server, which may
  // have kept it waiting.
  double latency_ms = 0;
  LiveTimes times;
  size_t num_bytes = 0;  // the size of the frame
};

struct LoadResult {
  std::vector<std::vector<LoadSample>> clients;
  int num_intended = 0;  // the number of poses in the schedule
  int num_sent = 0, num_superseded = 0, num_rejected = 0, num_resumed = 0;
  double seconds = 0;             // from the start to the last frame
  double server_cpu_seconds = 0;  // processor time of the whole server from first to last frame
};

// Returns when client `client` sends its poses, in seconds since the start, ascending. The list is
// empty for kClosed.
std::vector<double> SendTimes(const LoadOptions& options, int client);

// Plays `poses` back and forth in every session. kCancelled as soon as `interrupted` says so,
// otherwise the error of the first session that failed.
absl::StatusOr<LoadResult> RunLoad(RemotePoses& remote, const ClipQuery& character,
                                   const std::vector<Pose>& poses, const LoadOptions& options,
                                   const std::function<bool()>& interrupted);

}  // namespace pleat
