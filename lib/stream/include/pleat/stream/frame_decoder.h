// Draco bytes of a stream -> positions in the character's own vertex order. Bytes are hostile.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/mesh/topology.h"
#include "pleat/stream/stream_header.h"

namespace pleat {

class DeltaPredictor;

// kInvalidArgument names what a decoder cannot use: counts, box, vertex order.
absl::Status CheckStreamHeader(const StreamHeader& header, const MeshLimits& limits = {});

// Draco is memory-safe on hostile bytes but not resource-safe (an 86-byte file reached 22 GB), and
// accepts face indices that do not exist. So every header count is compared with what the stream
// declared before Draco allocates, attributes before their values are decoded, indices afterwards.
class FrameDecoder {
 public:
  // Decodes and checks the topology. kInvalidArgument or kDataLoss names what is wrong.
  static absl::StatusOr<FrameDecoder> Create(StreamHeader header, const MeshLimits& limits = {});

  const StreamHeader& header() const { return header_; }
  // Triangles over the character's vertices, in the order of the topology mesh.
  const Topology& topology() const { return topology_; }
  const Eigen::Matrix3Xf& reference() const { return reference_; }  // 3 x V, decoded

  // Fills `positions` (3 x V, meters, character's vertex order). kDataLoss says what is wrong; then
  // `positions` holds nothing useful. Not for two threads at once.
  // `mark` is the frame's own; streams other than kDracoDelta do without. In those a frame that is
  // a difference needs the frame before: after an error only a key frame is decoded again.
  absl::Status Decode(std::string_view bytes, const FrameMark& mark, Eigen::Matrix3Xf* positions);
  absl::Status Decode(std::string_view bytes, Eigen::Matrix3Xf* positions) {
    return Decode(bytes, FrameMark{}, positions);
  }

 private:
  FrameDecoder(StreamHeader header, Topology topology, Eigen::Matrix3Xf reference);

  StreamHeader header_;
  Topology topology_;
  Eigen::Matrix3Xf reference_;
  Eigen::Matrix3Xf points_;  // 3 x number of points in the last frame
  std::vector<int32_t> point_vertices_;
  // Of kDracoDelta streams:
  absl::Status DecodeDelta(std::string_view bytes, const FrameMark& mark,
                           Eigen::Matrix3Xf* positions);
  std::shared_ptr<const DeltaPredictor> predictor_;
  Eigen::Matrix3Xi last_, now_,
      residuals_;  // 3 x V, on the grid; last_ is empty before a key frame
};

}  // namespace pleat
