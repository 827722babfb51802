// Load on a server: many live sessions at a fixed rate, and how long every frame took.
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
  kClosed,   // the next pose when the frame of the last one is there: finds the throughput
};

struct LoadOptions {
  int num_clients = 1;
  double rate_fps = 30;  // per client; not used by kClosed
  double seconds = 10;
  Arrivals arrivals = Arrivals::kFixed;
  uint64_t seed = 1;
  LiveSessionOptions session{.decode = false};
};

struct LoadSample {
  double sent_s = 0;      // when the pose should have been sent, since the start
  double latency_ms = 0;  // from then to the frame: a late sender is the server's fault
  LiveTimes times;
  size_t num_bytes = 0;  // of the frame
};

struct LoadResult {
  std::vector<std::vector<LoadSample>> clients;
  int num_intended = 0;  // poses that the schedule has
  int num_sent = 0, num_superseded = 0, num_rejected = 0, num_resumed = 0;
  double seconds = 0;             // from the start to the last frame
  double server_cpu_seconds = 0;  // of the whole server during that time
};

// When client `client` sends its poses, seconds since the start, ascending.
std::vector<double> SendTimes(const LoadOptions& options, int client);

// Plays `poses` to and fro in every session. kCancelled as soon as `interrupted` says so.
absl::StatusOr<LoadResult> RunLoad(RemotePoses& remote, const ClipQuery& character,
                                   const std::vector<Pose>& poses, const LoadOptions& options,
                                   const std::function<bool()>& interrupted);

}  // namespace pleat
