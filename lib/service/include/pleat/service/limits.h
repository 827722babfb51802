// The one list of what the service refuses, and the numbers that both sides of a stream agree on.
#pragma once

#include <cstdint>

namespace pleat {

// What the operator may change. A request above a limit gets a status that names the limit, the
// flag that sets it and both numbers.
struct ServiceLimits {
  // Bytes of one uploaded file, a sequence or a compressed sequence. The check of an upload holds
  // the whole file in memory, so this bounds what one client can make the server allocate.
  int64_t max_upload_bytes = int64_t{4} << 30;
  // Vertices of one frame; faces may be twice as many. A scanned person has 10,000 to 200,000.
  int64_t max_vertices = 1'000'000;
  // Frames of one sequence or clip: eleven minutes at 30 frames per second, and about the largest
  // clip that fits into one message.
  int64_t max_frames = 20'000;
  // Sequences of one training job. All of them are in memory while it trains.
  int64_t max_clips = 64;
  // Bytes of a user's own rig. It travels in the request of a job, and messages are smaller than
  // GrpcServerOptions::max_receive_bytes.
  int64_t max_rig_bytes = int64_t{12} << 20;
};

// Poses of one query: the one that is shown and those before it. A model's history is 1 to 8.
inline constexpr int64_t kMaxPosesPerQuery = 8;
// Poses of one live session that may be under way. More hide the longest ways to a server (64
// poses at 60 per second are a second) and each costs memory on both sides.
inline constexpr int64_t kMaxPosesInFlight = 64;
// Items of one page of a list: with the largest descriptions a page stays below 4 MiB.
inline constexpr int64_t kMaxPageSize = 500;
// Bytes of one piece of an upload: the server keeps one piece per upload.
inline constexpr int64_t kMaxUploadChunkBytes = int64_t{2} << 20;
// Bytes of one piece of a download.
inline constexpr int64_t kDownloadPieceBytes = int64_t{512} << 10;

}  // namespace pleat
