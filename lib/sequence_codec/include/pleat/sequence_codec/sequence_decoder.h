// Compressed sequences (.plt, docs/formats/compressed_sequence.md) -> frames. Bytes are hostile.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// What the file was asked to keep.
struct CompressionPromise {
  double max_error_mm = 0;  // of every vertex of every frame, where positive
  double grid_step_mm =
      0;  // positions are exactly the nearest points of such a grid, where positive
};

class SequenceDecoder {
 public:
  // Reads what all frames share and the places of the rest; every section's checksum is verified.
  // `bytes` is kept. kInvalidArgument: no compressed sequence, or another version. kDataLoss: cut
  // off or damaged. kResourceExhausted: over a limit.
  static absl::StatusOr<SequenceDecoder> Open(std::string bytes, const MeshLimits& limits = {});
  ~SequenceDecoder();
  SequenceDecoder(SequenceDecoder&&) noexcept;
  SequenceDecoder& operator=(SequenceDecoder&&) noexcept;

  int num_frames() const;
  int num_vertices() const;
  FrameRate frame_rate() const;
  const std::string& name() const;
  const Topology& topology() const;
  const MeshAppearance& appearance() const;
  CompressionPromise promise() const;
  // Of the file: connectivity, face order and appearance.
  uint64_t topology_bytes() const;

  // Memory that this decoder takes at most: the file, the fields of its largest segment, one group
  // of frames, and an estimate of what all frames share.
  uint64_t memory_bytes() const;

  using FrameSink = std::function<absl::Status(int t, const Eigen::Matrix3Xf& positions)>;

  // Gives the frames [begin, end) to `sink`, in order (3 x V, meters). Work is proportional to the
  // range plus the fields of each segment (up to 512 frames) that it touches. Frames are exactly
  // the ones that the encoder measured: a checksum of every 16 frames says so, else kDataLoss.
  // kInvalidArgument when the range is not inside the sequence; kCancelled; or the sink's error.
  // Not for two threads at once.
  absl::Status Decode(int begin, int end, const FrameSink& sink, const Progress& progress = {});

  // Frame t alone (3 x V, meters), as Decode gives it; valid until the next call. Frames in order
  // cost the same as by Decode: the segment and the group decoded last are kept.
  absl::StatusOr<const Eigen::Matrix3Xf*> DecodeFrame(int t);

  // All frames.
  absl::StatusOr<MeshSequence> DecodeAll(const Progress& progress = {});

 private:
  struct State;
  explicit SequenceDecoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pleat
