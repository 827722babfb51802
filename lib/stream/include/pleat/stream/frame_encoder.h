// Positions of one frame -> Draco bytes, with one grid and one vertex order for the whole session.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/topology.h"
#include "pleat/stream/stream_header.h"

namespace pleat {

struct FrameEncoderOptions {
  FrameEncoding encoding = FrameEncoding::kDracoPointCloud;
  StreamContent content = StreamContent::kMesh;
  int position_bits = 12;  // grid: 12 bits are about .5 mm on a person
  // Where positive: the grid is as fine as this bound on every vertex needs, and position_bits is
  // not used. 1e-3 mm to 1e6 mm, at most 2^20 steps per box edge.
  double max_error_mm = 0;
  // Of Draco, 0 = smallest .. 10 = fastest. From 6 on its vertex order no longer follows the
  // surface closely: samba's clouds grow from 23.7 to 28.2 kB and take longer.
  int speed = 5;
  // Edge of the box in largest edges of the reference frame's bounds.
  double box_margin = 1.25;
};

// One per thread: it owns the scratch memory of Draco.
class FrameEncoder {
 public:
  // reference: 3 x V, meters, usually the rest pose; it gives the box and the vertex order.
  // control_vertices: of kControlMesh, whose own topology and frames these are; for the header.
  // kInvalidArgument names a wrong option, count or vertex.
  static absl::StatusOr<FrameEncoder> Create(const Topology& topology,
                                             const Eigen::Ref<const Eigen::Matrix3Xf>& reference,
                                             const FrameEncoderOptions& options = {},
                                             std::vector<int32_t> control_vertices = {});
  ~FrameEncoder();
  FrameEncoder(FrameEncoder&&) noexcept;
  FrameEncoder& operator=(FrameEncoder&&) noexcept;

  const StreamHeader& header() const;

  // positions: 3 x V, meters. The decoded coordinates differ by at most half of box.step_m() (and
  // the rounding of float32). kInvalidArgument names the first vertex that is not finite,
  // kOutOfRange the first that is too far from the box.
  // In a kDracoDelta stream the frame is the cheaper of a key frame and a difference to the frame
  // encoded before: every frame must reach the decoder, in order. `bytes` are replaced and keep
  // their memory; differences are encoded without any allocation after the first of them, all other
  // frames by Draco, which allocates.
  absl::Status Encode(const Eigen::Ref<const Eigen::Matrix3Xf>& positions, std::string* bytes);
  // The same as a new string.
  absl::StatusOr<std::string> Encode(const Eigen::Ref<const Eigen::Matrix3Xf>& positions);
  // Of the frame encoded last.
  const FrameMark& mark() const;
  // The next frame of a kDracoDelta stream will be a key frame (a decoder has lost its state).
  void RequestKeyframe();

 private:
  struct State;
  explicit FrameEncoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pleat
