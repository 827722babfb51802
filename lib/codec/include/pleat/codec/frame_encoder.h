// Positions of one frame -> Draco bytes, with one grid and one vertex order for the whole session.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/codec/stream_header.h"
#include "pleat/mesh/topology.h"

namespace pleat {

struct FrameEncoderOptions {
  FrameEncoding encoding = FrameEncoding::kDracoPointCloud;
  int position_bits = 12;  // grid: 12 bits are about .5 mm on a person
  // Of Draco, 0 = smallest .. 10 = fastest. From 6 on its vertex order no longer follows the
  // surface closely: samba's clouds grow from 23.7 to 28.2 kB and take longer.
  int speed = 5;
  // Edge of the box in largest edges of the reference frame's bounds.
  double box_margin = 1.25;
};

// One per thread: it owns the scratch memory of Draco.
class FrameEncoder {
 public:
  // reference: 3 x V, metres, usually the rest pose; it gives the box and the vertex order.
  // kInvalidArgument names a wrong option, count or vertex.
  static absl::StatusOr<FrameEncoder> Create(const Topology& topology,
                                             const Eigen::Ref<const Eigen::Matrix3Xf>& reference,
                                             const FrameEncoderOptions& options = {});
  ~FrameEncoder();
  FrameEncoder(FrameEncoder&&) noexcept;
  FrameEncoder& operator=(FrameEncoder&&) noexcept;

  const StreamHeader& header() const;

  // positions: 3 x V, metres. The decoded coordinates differ by at most half of box.step_m() (and
  // the rounding of float32). kInvalidArgument names the first vertex that is not finite,
  // kOutOfRange the first that is too far from the box.
  absl::StatusOr<std::string> Encode(const Eigen::Ref<const Eigen::Matrix3Xf>& positions);

 private:
  struct State;
  explicit FrameEncoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pleat
