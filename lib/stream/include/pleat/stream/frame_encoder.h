// Encodes the positions of frames as Draco bytes, with one grid and one vertex order for the whole
// session (docs/method/streams.md).
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
  // Bits per coordinate of the grid, 8 to 20. Twelve bits are about .5 mm per step on a person.
  int position_bits = 12;
  // When it is positive, the grid is as fine as this bound on the error of every vertex requires,
  // and position_bits is not used. Allowed are 1e-3 to 1e6 mm, with at most 2^20 steps per box
  // edge.
  double max_error_mm = 0;
  // Draco's speed, from 0 (smallest) to 10 (fastest). From 6 on its vertex order no longer follows
  // the surface closely: the clouds of the samba capture grow from 23.7 to 28.2 kB and take longer.
  int speed = 5;
  // The edge of the box as a multiple of the largest edge of the reference frame's bounds, 1 to
  // 100.
  double box_margin = 1.25;
};

// One encoder serves one thread: it owns Draco's scratch memory and, in a kDracoDelta stream, the
// last frame.
class FrameEncoder {
 public:
  // reference: 3 x V, meters, usually the rest pose. The box is laid around it, and its encoding
  // gives the vertex order.
  // control_vertices: for kControlMesh, the character's vertices that `topology` and the frames
  // consist of. They only go into the header.
  // kInvalidArgument names the wrong option, count or vertex.
  static absl::StatusOr<FrameEncoder> Create(const Topology& topology,
                                             const Eigen::Ref<const Eigen::Matrix3Xf>& reference,
                                             const FrameEncoderOptions& options = {},
                                             std::vector<int32_t> control_vertices = {});
  ~FrameEncoder();
  FrameEncoder(FrameEncoder&&) noexcept;
  FrameEncoder& operator=(FrameEncoder&&) noexcept;

  const StreamHeader& header() const;

  // positions: 3 x V, meters. Decoded coordinates differ from them by at most half of box.step_m(),
  // apart from the rounding of float32. kInvalidArgument names the first vertex that is not finite,
  // kOutOfRange the first one that is too far from the box. A frame that fails is not part of the
  // stream: the next difference refers to the last frame that was encoded.
  //
  // In a kDracoDelta stream the frame is a difference from the frame encoded before it, or a key
  // frame where that is cheaper. Every frame must therefore reach the decoder, in order.
  //
  // `bytes` are replaced and keep their memory. Into bytes that have held a frame of this session,
  // differences allocate nothing, except where ResidualWriter leaves the residuals to Draco. All
  // other frames are encoded by Draco, which allocates.
  absl::Status Encode(const Eigen::Ref<const Eigen::Matrix3Xf>& positions, std::string* bytes);
  // Does the same and returns a new string.
  absl::StatusOr<std::string> Encode(const Eigen::Ref<const Eigen::Matrix3Xf>& positions);
  // Returns the mark of the frame that was encoded last.
  const FrameMark& mark() const;
  // Makes the next frame of a kDracoDelta stream a key frame, for a decoder that has lost its
  // state.
  void RequestKeyframe();

 private:
  struct State;
  explicit FrameEncoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pleat
