// Pose sessions on the wire.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/service/pose_session.h"
#include "pleat/v1/pose_service.pb.h"

namespace pleat {

inline constexpr int kMaxHistory = 8;  // poses per query, the shown one included

struct SessionRequest {
  std::string model_id;
  PoseSessionOptions options;
};
absl::StatusOr<SessionRequest> FromProto(const v1::Character& character,
                                         const v1::StreamOptions& options);

v1::Frame ToProto(uint64_t number, EncodedFrame frame);

}  // namespace pleat
