// A live session: poses go out, frames come back in the same order.
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
  // Of streams of parameters: evaluates them, so that LiveFrame::positions are the mesh. Without it
  // the parameters are all there is.
  std::shared_ptr<const CharacterModel> model{};
  // Poses without an answer that may be under way, 1 to 64: more hide the way to the server, fewer
  // make an edit show sooner.
  int max_in_flight = 4;
  // A pose that waits for its turn is replaced by a newer one: the frames are as many as server,
  // network and reader can take, and always of the newest pose. For editing by hand.
  bool latest_wins = false;
  // false: LiveFrame::positions stay empty, for those who forward or count frames.
  bool decode = true;
  // Attempts in a row to go on after the connection or the server has ended. The session then
  // starts anew with a key frame and the poses that have no answer yet.
  int max_reconnects = 5;
};

// What the server says about its work on one frame, microseconds.
struct LiveTimes {
  uint32_t queue_us = 0;  // until the evaluation started
  uint32_t evaluate_us = 0, encode_us = 0;
  uint64_t server_cpu_us = 0;       // processor time of the whole server since its start
  uint32_t evaluated_together = 0;  // poses of the model that were evaluated at once
};

struct LiveFrame {
  uint64_t number = 0;  // of the pose
  // 3 x V, meters, the character's vertex order (or that of its control mesh).
  Eigen::Matrix3Xf positions;
  std::optional<FrameParameters> parameters;  // of streams of parameters
  double confidence = 0;
  std::string draco;     // what came over the wire
  size_t num_bytes = 0;  // of `draco`, or of the message of the parameters
  FrameMark mark;
  int num_superseded = 0;  // poses before this one that get no frame
  LiveTimes times;
  bool resumed = false;  // the first frame after a new connection
};

// Send and Receive may run on two threads, each on one. Every pose gets one answer, in order; with
// latest_wins only the newest of those that wait.
class LiveSession {
 public:
  virtual ~LiveSession() = default;  // ends the session, waiting for nothing

  // What the first reply says.
  virtual const StreamHeader& header() const = 0;
  // Connectivity, vertex order and grid; not of streams of parameters.
  virtual const FrameDecoder& decoder() const = 0;

  // history: the poses 1, 2, ... training-frame intervals earlier; empty = the poses sent before.
  // restart: forget those (a cut). keyframe: of kDracoDelta streams, answer with a key frame.
  // Waits while max_in_flight poses have no answer (not with latest_wins) and while the session
  // reconnects. kUnavailable when the session has ended: Receive says why.
  virtual absl::Status Send(uint64_t number, const Pose& pose,
                            const std::vector<Pose>& history = {}, bool restart = false,
                            bool keyframe = false) = 0;

  // The next frame. When ended(), an error is the end: kOutOfRange after SendDone. Else it is about
  // pose frame->number alone and the session goes on: the server cannot show it, or kDataLoss, the
  // frame does not decode (then ask for a key frame).
  virtual absl::Status Receive(LiveFrame* frame) = 0;
  virtual bool ended() const = 0;

  // Says that no pose will follow; Receive gives the frames that are still to come.
  virtual void SendDone() = 0;
};

}  // namespace pleat
