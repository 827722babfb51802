// Decodes the Draco bytes of a stream into positions in the character's own vertex order. The bytes
// are treated as hostile.
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

// Returns OK when a decoder can use `header`. kInvalidArgument names the field that it cannot use:
// a count, the box, the control vertices or the vertex order. The topology bytes are not read here.
absl::Status CheckStreamHeader(const StreamHeader& header, const MeshLimits& limits = {});

// Draco is memory-safe on hostile bytes, but it is not resource-safe (an 86-byte file reached
// 22 GB), and it accepts face indices that do not exist. Hence there are three checks against what
// the stream declared: the counts of every frame before Draco allocates anything, the attributes
// before their values are decoded, and the indices afterwards.
//
// One decoder serves one thread: it owns scratch memory and, in a kDracoDelta stream, the last
// frame.
class FrameDecoder {
 public:
  // Decodes and checks the topology. kInvalidArgument says what is wrong with the header, kDataLoss
  // what is wrong with the bytes of its topology.
  static absl::StatusOr<FrameDecoder> Create(StreamHeader header, const MeshLimits& limits = {});

  const StreamHeader& header() const { return header_; }
  // The triangles index the character's vertices and stand in the order of the topology mesh.
  const Topology& topology() const { return topology_; }
  // The reference frame as it was decoded from the header: 3 x V, meters.
  const Eigen::Matrix3Xf& reference() const { return reference_; }

  // Fills `positions` (3 x V, meters, in the character's vertex order). After an error `positions`
  // holds nothing useful; kDataLoss says what is wrong with the bytes.
  //
  // `mark` travels beside the bytes and is used in kDracoDelta streams only. There a difference
  // needs the frame before it. After any error the decoder forgets that frame, and every difference
  // returns kFailedPrecondition until a key frame comes.
  absl::Status Decode(std::string_view bytes, const FrameMark& mark, Eigen::Matrix3Xf* positions);
  absl::Status Decode(std::string_view bytes, Eigen::Matrix3Xf* positions) {
    return Decode(bytes, FrameMark{}, positions);
  }

 private:
  FrameDecoder(StreamHeader header, Topology topology, Eigen::Matrix3Xf reference);

  StreamHeader header_;
  Topology topology_;
  Eigen::Matrix3Xf reference_;
  // Scratch memory: the points of the last frame (3 x P) and the vertex of each of them.
  Eigen::Matrix3Xf points_;
  std::vector<int32_t> point_vertices_;

  // The rest serves kDracoDelta streams.
  absl::Status DecodeDelta(std::string_view bytes, const FrameMark& mark,
                           Eigen::Matrix3Xf* positions);
  std::shared_ptr<const DeltaPredictor> predictor_;
  // 3 x V, in grid steps. last_ is empty while a key frame must come next.
  Eigen::Matrix3Xi last_, now_, residuals_;
};

}  // namespace pleat
