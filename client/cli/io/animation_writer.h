// Writes an animation frame by frame, in the form that the name of OUT asks for.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/io/space.h"
#include "pleat/formats/npz.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/mesh/topology.h"
#include "pleat/stream/frame_encoder.h"

namespace pleat {

enum class AnimationFormat {
  kPc2,    // OUT.pc2 and OUT.obj with its topology
  kPseq,   // OUT.pseq, Pleat's own sequence file
  kAbc,    // OUT.abc, an Alembic archive
  kMdd,    // OUT.mdd and OUT.obj with its topology
  kNpz,    // OUT.npz, an archive of NumPy arrays
  kNpy,    // OUT.npy, one array, and OUT.obj with its topology
  kGlb,    // OUT.glb, binary glTF with a morph target for each frame
  kUsda,   // OUT.usda, USD text with time samples
  kObj,    // a folder OUT with frame_0000.obj and so on
  kPly,    // a folder OUT with frame_0000.ply and so on
  kDraco,  // a folder OUT with frame_0000.drc and so on (draco_folder.h)
};

struct AnimationFormatInfo {
  AnimationFormat format;
  std::string name;              // as --format has it
  bool is_file = true;           // with the ending .NAME; else a folder
  bool has_mesh_beside = false;  // an .obj of the same stem
};
const std::vector<AnimationFormatInfo>& AnimationFormats();
const AnimationFormatInfo& InfoOf(AnimationFormat format);
// ".pc2, .mdd, ...": the endings of all formats that are files.
std::string AnimationEndings();
// The description of a flag --format.
std::string FormatFlagHelp(const std::string& folder_format);

// Returns the format with this name, or for "auto" that of the ending of `path`; any other path is
// a folder of `folder_format`.
absl::StatusOr<AnimationFormat> ChooseAnimationFormat(
    const std::string& name, const std::string& path,
    AnimationFormat folder_format = AnimationFormat::kDraco);

struct AnimationOptions {
  FrameRate frame_rate;
  MeshAppearance appearance;
  std::string name;  // the name of the sequence, for the files that can hold it
  // For the formats that say it: the number of the first frame, and what positions are in.
  double first_frame = 0;
  Space space;
  NpzKeys npz_keys;  // for kNpz
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
