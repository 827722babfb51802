// One encoding of an analyzed sequence at one quantization step.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "motion_segment.h"
#include "pleat/base/bytes.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "residual_coder.h"
#include "sequence_analysis.h"

namespace pleat {

class SequenceEncoder {
 public:
  // Codes what does not depend on the rate. num_threads: 0 = one per core.
  // origin_m: what a decoder adds to the positions of `sequence`.
  SequenceEncoder(const MeshSequence& sequence, SequenceAnalysis analysis,
                  const Eigen::Vector3d& origin_m, bool keep_face_order, int num_threads);

  // The whole file. step_m: of the fields, the one number that sets the rate; grid: of the residual
  // layer. Errors: see CompressSequence.
  absl::StatusOr<std::string> Encode(double step_m, const ResidualGrid& grid,
                                     const Progress& progress) const;

  // Connectivity, face order and appearance, in bytes.
  uint64_t topology_bytes() const { return topology_.size() + appearance_.size(); }
  // Components that are worth coding at that step.
  int NumComponents(const SegmentAnalysis& segment, double step_m) const;
  const SequenceAnalysis& analysis() const { return analysis_; }

 private:
  struct Shared;
  absl::Status EncodeSegment(const SegmentAnalysis& segment, const Shared& shared,
                             const Progress& progress, ByteWriter* writer) const;
  absl::Status EncodeGroups(const MotionSegment& segment, const Shared& shared,
                            const Progress& progress, ByteWriter* writer) const;

  const MeshSequence& sequence_;
  const SequenceAnalysis analysis_;
  const Eigen::Vector3d origin_m_;
  const int num_threads_;
  std::string topology_, appearance_;
  bool is_face_list_ = false;  // the topology is coded in the order of the file
};

}  // namespace pleat
