// Writes an animation frame by frame, in the form that the name of OUT asks for.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/mesh/topology.h"
#include "pleat/stream/frame_encoder.h"

namespace pleat {

enum class AnimationFormat {
  kPc2,    // OUT.pc2 and OUT.obj with its topology
  kPseq,   // OUT.pseq, Pleat's own sequence file
  kAbc,    // OUT.abc, an Alembic archive
  kObj,    // a folder OUT with frame_0000.obj and so on
  kPly,    // a folder OUT with frame_0000.ply and so on
  kDraco,  // a folder OUT with frame_0000.drc and so on (draco_folder.h)
};

// Returns the format with this name: "pc2", "abc", "pseq", "obj", "ply", "drc", or "auto". "auto"
// goes by the ending of `path`, .pc2, .abc or .pseq; any other path is a folder of `folder_format`.
absl::StatusOr<AnimationFormat> ChooseAnimationFormat(
    const std::string& name, const std::string& path,
    AnimationFormat folder_format = AnimationFormat::kDraco);

struct AnimationOptions {
  FrameRate frame_rate;
  MeshAppearance appearance;
  std::string name;  // the name of the sequence, for .pseq and .abc
  // Both are for kDraco only. reference: 3 x V, the rest pose, meters; empty: the first frame.
  FrameEncoderOptions encoder{.encoding = FrameEncoding::kDracoMesh};
  Eigen::Matrix3Xf reference;
};

class AnimationWriter {
 public:
  virtual ~AnimationWriter() = default;
  virtual absl::Status AddFrame(const Eigen::Matrix3Xf& positions) = 0;  // 3 x V, meters
  // Completes the files. kInvalidArgument when no frame was added.
  virtual absl::Status Finish() = 0;
};

std::unique_ptr<AnimationWriter> MakeAnimationWriter(AnimationFormat format,
                                                     const std::string& path,
                                                     const Topology& topology,
                                                     AnimationOptions options);

}  // namespace pleat
