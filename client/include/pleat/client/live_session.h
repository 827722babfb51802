// A live session: poses go out, frames come back in the same order.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pleat/codec/frame_decoder.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

struct LiveFrame {
  uint64_t number = 0;         // of the pose
  Eigen::Matrix3Xf positions;  // 3 x V, metres, the character's vertex order
  double confidence = 0;
  std::string draco;  // what came over the wire
  FrameMark mark;
};

// Send and Receive may run on two threads, each on one. The server answers every pose with one
// frame and reads no further pose while the client does not read, so a client that sends without
// receiving blocks after some poses.
class LiveSession {
 public:
  virtual ~LiveSession() = default;  // ends the session, waiting for nothing

  // Connectivity, vertex order and grid, from the first reply.
  virtual const FrameDecoder& decoder() const = 0;

  // history: the poses 1, 2, ... training-frame intervals earlier; empty = the poses sent before.
  // restart: forget those (a cut). keyframe: of kDracoDelta streams, answer with a key frame.
  // kUnavailable when the session has ended: Receive says why.
  virtual absl::Status Send(uint64_t number, const Pose& pose,
                            const std::vector<Pose>& history = {}, bool restart = false,
                            bool keyframe = false) = 0;

  // The next frame. kOutOfRange when the server has ended the session without error.
  virtual absl::Status Receive(LiveFrame* frame) = 0;

  // Says that no pose will follow; Receive gives the frames that are still to come.
  virtual void SendDone() = 0;
};

}  // namespace pleat
