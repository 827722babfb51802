// A live session: poses go out, and frames come back in the same order (docs/live_sessions.md).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/skeleton/pose.h"
#include "pleat/stream/frame_decoder.h"
#include "pleat/stream/frame_encoder.h"

namespace pleat {

struct LiveSessionOptions {
  FrameEncoderOptions stream{};
  // For streams of parameters: the model that evaluates them, so that LiveFrame::positions are the
  // mesh. Without it, the parameters are all there is.
  std::shared_ptr<const CharacterModel> model{};
  // The number of poses that may be under way without an answer, 1 to 64. More of them hide the
  // delay of the network, fewer make an edit visible sooner.
  int max_in_flight = 4;
  // A pose that waits for its turn is replaced by a newer one. There are then as many frames as
  // server, network and reader can take, always of the newest pose. For editing by hand.
  bool latest_wins = false;
  // false: LiveFrame::positions stay empty, for programs that only forward or count frames.
  bool decode = true;
  // The number of attempts in a row to go on after the connection or the server has ended. The
  // session then starts anew with a key frame and the poses that have no answer yet.
  int max_reconnects = 5;
};

// What the server says about its work on one frame. Times are in microseconds.
struct LiveTimes {
  uint32_t queue_us = 0;  // from the arrival of the pose to the start of its evaluation
  uint32_t evaluate_us = 0, encode_us = 0;
  uint64_t server_cpu_us = 0;       // processor time of the whole server since its start
  uint32_t evaluated_together = 0;  // poses of the model that were evaluated at once
};

struct LiveFrame {
  uint64_t number = 0;  // the number of the pose, as it was sent
  // 3 x V, meters, in the vertex order of the character or of its control mesh.
  Eigen::Matrix3Xf positions;
  std::optional<FrameParameters> parameters;  // in streams of parameters
  double confidence = 0;
  std::string draco;     // what came over the wire
  size_t num_bytes = 0;  // the size of `draco`, or of the message with the parameters
  FrameMark mark;
  int num_superseded = 0;  // poses before this one that get no frame
  LiveTimes times;
  bool resumed = false;  // this is the first frame after a new connection
};

// Send and SendDone may run on one thread while Receive runs on another one. Every pose gets one
// answer, in order; with latest_wins, only the newest of those that wait gets one. Neither may be
// running when the session is destroyed.
class LiveSession {
 public:
  virtual ~LiveSession() = default;  // ends the session and waits for no more answers

  // The header of the stream, which comes with the first reply.
  virtual const StreamHeader& header() const = 0;
  // The decoder knows connectivity, vertex order and grid. A stream of parameters has none.
  virtual const FrameDecoder& decoder() const = 0;

  // Sends a pose.
  // history: the poses 1, 2, ... training-frame intervals earlier; empty = the poses sent before.
  // restart: forgets the poses sent before, after a cut. keyframe: asks a kDracoDelta stream for a
  // key frame.
  // Waits while max_in_flight poses have no answer (except with latest_wins) and while the session
  // reconnects. kUnavailable when the session has ended; Receive says why.
  virtual absl::Status Send(uint64_t number, const Pose& pose,
                            const std::vector<Pose>& history = {}, bool restart = false,
                            bool keyframe = false) = 0;

  // Waits for the next answer and fills `frame`. An error means one of two things. When ended(), it
  // is the end of the session, and kOutOfRange is the regular one, after SendDone. Otherwise it
  // concerns the pose frame->number alone and the session goes on: the server cannot show the pose,
  // or the frame does not decode (kDataLoss; ask for a key frame then).
  virtual absl::Status Receive(LiveFrame* frame) = 0;
  virtual bool ended() const = 0;

  // Says that no pose will follow. Receive gives the frames that are still to come.
  virtual void SendDone() = 0;
};

}  // namespace pleat
