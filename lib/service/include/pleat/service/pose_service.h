// Frames of stored characters: one pose, a clip, or poses as they happen.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/service/limits.h"
#include "pleat/skeleton/pose.h"
#include "pleat/stream/frame_encoder.h"

namespace pleat {

struct ClipQuery {
  std::string model_id;
  PoseTrack track;
  std::vector<double> bone_scales;  // J or empty
  bool skinned_only = false;
  DetailStrengths strengths{};  // of the learned detail
};

struct PoseSessionOptions {
  std::vector<double> bone_scales{};  // J or empty
  bool skinned_only = false;
  FrameEncoderOptions encoder{};
  DetailStrengths strengths{};  // of the learned detail; parameters do not carry them
};

struct EncodedFrame {
  std::string draco{};                          // empty in a stream of parameters
  std::optional<FrameParameters> parameters{};  // of such a stream
  double confidence = 0;
  FrameMark mark{};
  double evaluate_us = 0, encode_us = 0;  // elapsed time, microseconds
};

// Single poses of one character as encoded frames. Not for two threads at once.
class PoseSession {
 public:
  virtual ~PoseSession() = default;
  virtual const StreamHeader& header() const = 0;
  // poses[0] is shown, poses[h] is the pose h training-frame intervals earlier.
  virtual absl::StatusOr<EncodedFrame> Show(const std::vector<const Pose*>& poses) = 0;
};

// The frames of one clip, one after the other, as fast as the caller takes them. Not for two
// threads at once.
class ClipSession {
 public:
  virtual ~ClipSession() = default;
  virtual const StreamHeader& header() const = 0;
  virtual bool done() const = 0;
  virtual int next_frame() const = 0;
  // The frame next_frame(); call it while not done.
  virtual absl::StatusOr<EncodedFrame> Next() = 0;
};

struct LiveRules {
  // latest_wins: replies that were sent and not acknowledged; else: poses that wait.
  int max_in_flight = 4;
  // A pose that waits is replaced by a newer one.
  bool latest_wins = false;
};

struct LivePose {
  uint64_t number = 0;
  absl::Status status{};  // not OK: cannot be shown, the rest is not used
  Pose pose{};
  std::vector<Pose> history{};  // 1, 2, ... intervals earlier; empty: the poses before
  bool restart = false;         // forget those
  bool keyframe = false;
};

struct LiveReply {
  uint64_t number = 0;  // of the pose
  // An error says why this pose cannot be shown; the stream goes on.
  absl::StatusOr<EncodedFrame> frame = EncodedFrame();
  int num_superseded = 0;  // poses before this one that get no reply
  double queue_us = 0;     // from the arrival of the pose to its evaluation
  int num_together = 0;    // poses of the model that were evaluated at once
};

// Where the replies of a pose stream go.
class LiveListener {
 public:
  // Runs on a thread of the service. It may take the frame out of the reply or exchange it; the
  // stream uses the memory that is left for its next reply. It may call Answer or destroy the
  // stream, but must not touch `reply` after that.
  virtual void OnReply(LiveReply&& reply) = 0;

 protected:
  ~LiveListener() = default;
};

// Poses of one character in, replies out, in the same order, as they happen. What waits is bounded
// whatever the caller does. Thread-safe, but two calls of Answer never overlap.
class PoseStream {
 public:
  // Call it when no reply is under way, or from OnReply.
  virtual ~PoseStream() = default;
  virtual const StreamHeader& header() const = 0;

  // False: do not read further poses now.
  virtual bool HasRoom() const = 0;
  // Copies what it needs.
  virtual void Push(const LivePose& pose) = 0;
  // `num_replies` of this stream were read by the client; an older number changes nothing.
  // kInvalidArgument when there were not as many.
  virtual absl::Status Acknowledge(uint64_t num_replies) = 0;

  virtual bool empty() const = 0;  // no pose waits
  virtual bool ready() const = 0;  // a pose waits and the rules let it be answered now
  // Answers the next pose by one call of the listener, soon. Call it when not empty; which pose
  // that is, and whether newer ones have replaced it, is decided when its evaluation begins.
  virtual void Answer() = 0;
};

// Thread-safe. kNotFound for a model that the service does not have.
class PoseService {
 public:
  virtual ~PoseService() = default;

  // Every frame of the clip in order; `consume` may stop it with an error.
  virtual absl::Status EvaluateClip(
      const ClipQuery& query,
      const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) = 0;

  virtual absl::StatusOr<std::unique_ptr<PoseSession>> OpenSession(const std::string& model_id,
                                                                   PoseSessionOptions options) = 0;
  // kInvalidArgument names the first pose that does not fit the skeleton.
  virtual absl::StatusOr<std::unique_ptr<ClipSession>> OpenClip(const std::string& model_id,
                                                                PoseTrack track,
                                                                PoseSessionOptions options) = 0;
  // `listener` must outlive the stream. kUnimplemented where poses cannot be answered without
  // blocking (the remote service: RemotePoses::OpenLiveSession is its door).
  virtual absl::StatusOr<std::unique_ptr<PoseStream>> OpenStream(const std::string& model_id,
                                                                 PoseSessionOptions options,
                                                                 LiveRules rules,
                                                                 LiveListener* listener) = 0;
};

// What a stream of one clip gives, in this order; an error from any of them ends the stream.
struct ClipStreamSink {
  std::function<absl::Status(const StreamHeader&)> on_header{};  // may be null
  std::function<absl::Status(int frame_index, std::string_view draco, const FrameMark& mark,
                             double confidence)>
      on_frame{};
  // In its place for streams of parameters.
  std::function<absl::Status(int frame_index, const FrameParameters&)> on_parameters{};
};

// The frames of a clip as they are sent, for those who keep or forward them.
absl::Status StreamClip(PoseService& poses, const ClipQuery& query,
                        const FrameEncoderOptions& encoding, const ClipStreamSink& sink);

}  // namespace pleat
