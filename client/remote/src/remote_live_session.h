// The client's half of a live session, with reconnection.
#pragma once

#include <grpcpp/channel.h>

#include <memory>

#include "absl/status/statusor.h"
#include "pleat/remote/live_session.h"
#include "pleat/v1/pose_service.pb.h"

namespace pleat {

// Opens a session and reads its header. kInvalidArgument when max_in_flight is out of range,
// otherwise the error of the server.
absl::StatusOr<std::unique_ptr<LiveSession>> OpenRemoteLiveSession(
    std::shared_ptr<grpc::Channel> channel, v1::Character character,
    const LiveSessionOptions& options);

}  // namespace pleat
