// Writing an animation frame by frame, in the form that the name of OUT asks for.
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
  kObj,    // folder OUT with frame_0000.obj, ...
  kPly,    // folder OUT with frame_0000.ply, ...
  kDraco,  // folder OUT with frame_0000.drc, ... (draco_folder.h)
};

// name: "auto" (by the ending of `path`: .pc2, .pseq, else a folder of `folder_format`), "pc2",
// "pseq", "obj", "ply" or "drc".
absl::StatusOr<AnimationFormat> ChooseAnimationFormat(
    const std::string& name, const std::string& path,
    AnimationFormat folder_format = AnimationFormat::kDraco);

struct AnimationOptions {
  FrameRate frame_rate;
  MeshAppearance appearance;
  std::string name;  // of the sequence, .pseq only
  FrameEncoderOptions encoder{.encoding = FrameEncoding::kDracoMesh};  // kDraco only
  Eigen::Matrix3Xf reference;  // kDraco only: 3 x V, rest pose, meters; empty = the first frame
};

class AnimationWriter {
 public:
  virtual ~AnimationWriter() = default;
  virtual absl::Status AddFrame(const Eigen::Matrix3Xf& positions) = 0;  // 3 x V, meters
  // Completes the files; kInvalidArgument when no frame was added.
  virtual absl::Status Finish() = 0;
};

std::unique_ptr<AnimationWriter> MakeAnimationWriter(AnimationFormat format,
                                                     const std::string& path,
                                                     const Topology& topology,
                                                     AnimationOptions options);

}  // namespace pleat
