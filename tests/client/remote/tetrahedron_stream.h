// Messages of a stream of frames of the moving tetrahedron, as an honest server sends them.
#pragma once

#include <string>
#include <utility>

#include "client/test_sequence.h"
#include "pleat/stream/frame_encoder.h"
#include "pleat/v1/pose_service.pb.h"
#include "pleat/wire/stream_messages.h"

namespace pleat {

class TetrahedronStream {
 public:
  explicit TetrahedronStream(FrameEncoderOptions options = {})
      : encoder_(FrameEncoder::Create(clip_.topology(), clip_.frame(0), options).value()) {}

  v1::StreamHeader header() const { return ToProto(encoder_.header()); }
  double step_m() const { return encoder_.header().box.step_m(); }
  Eigen::Matrix3Xf positions(int t) const { return clip_.frame(t); }
  v1::Frame Frame(uint64_t number) {
    v1::Frame frame;
    frame.set_number(number);
    frame.set_confidence(.5);
    frame.set_draco(encoder_.Encode(positions(static_cast<int>(number) % 3)).value());
    return frame;
  }

 private:
  const MeshSequence clip_ = MovingTetrahedron(3);
  FrameEncoder encoder_;
};

// A pose of a skeleton of one joint, which stands at (x, 0, 0).
inline Pose PoseAt(double x) {
  Pose pose;
  pose.root_position = {x, 0, 0};
  pose.rotations = {Eigen::Quaterniond::Identity()};
  return pose;
}

}  // namespace pleat
