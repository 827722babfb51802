// One stream of decoded frames: a compressed sequence -> positions, without gRPC.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/local/memory_budget.h"
#include "pleat/sequence_codec/sequence_decoder.h"
#include "pleat/service/character_service.h"

namespace pleat {

class DecodeSession;

// Gives all frames that are left to `sink`.
absl::Status DecodeInto(DecodeSession* session, const DecodedFramesSink& sink);

// The frames of a range, one after the other, as fast as the caller takes them. Not for two threads
// at once.
class DecodeSession {
 public:
  // bytes: a .plt. `memory` is given back with the session. kInvalidArgument when the range is not
  // inside the sequence; else the errors of SequenceDecoder.
  static absl::StatusOr<std::unique_ptr<DecodeSession>> Open(SequenceDecoder decoder,
                                                             FrameRange range, Reservation memory);

  bool done() const { return next_ >= range_.end; }
  int next_frame() const { return next_; }
  // The frame next_frame() (3 x V, meters), valid until the next call; call while not done.
  absl::StatusOr<const Eigen::Matrix3Xf*> Next();

  // The first frame of the range with connectivity, appearance, name and frame rate; before Next.
  absl::StatusOr<MeshSequence> Shape();

 private:
  DecodeSession(SequenceDecoder decoder, FrameRange range, Reservation memory)
      : decoder_(std::move(decoder)),
        range_(range),
        next_(range.begin),
        memory_(std::move(memory)) {}

  SequenceDecoder decoder_;
  const FrameRange range_;
  int next_;
  Reservation memory_;
};

}  // namespace pleat
