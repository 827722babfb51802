#include "pleat/formats/joint_clip_reader.h"

#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "glb_joints.h"
#include "gltf_file.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/formats/bvh.h"
#include "sequence_inputs.h"

namespace pleat {
namespace {

absl::StatusOr<JointClipFile> ClipOfGlb(std::string_view bytes, const ReadMotionOptions& options) {
  InputReport report;
  PLEAT_ASSIGN_OR_RETURN(std::optional<JointClip> clip,
                         DecodeLargestGlbSkin(bytes, options.frame_rate, options.limits, &report));
  if (!clip) return absl::InvalidArgumentError("the file has no skin, so it has no joints");
  JointClipFile file{.clip = *std::move(clip), .warnings = {}};
  for (const InputNote& note : report.notes) file.warnings.push_back(note.text);
  return file;
}

absl::StatusOr<JointClipFile> DecodeClip(const std::string& path, std::string_view bytes,
                                         const ReadMotionOptions& options) {
  if (bytes.starts_with("glTF")) return ClipOfGlb(bytes, options);
  if (!IsBvhText(bytes) && IsGltfText(bytes)) {
    PLEAT_ASSIGN_OR_RETURN(const std::string packed, PackGltf(bytes, path, options.limits));
    return ClipOfGlb(packed, options);
  }
  if (!IsBvhText(bytes) && LowerExtension(path) != ".bvh") {
    return absl::InvalidArgumentError(
        "joints of another skeleton are read from .bvh, .glb and .gltf");
  }
  PLEAT_ASSIGN_OR_RETURN(BvhFile bvh, DecodeBvh(bytes, options.limits));
  return JointClipFile{std::move(bvh.clip), std::move(bvh.warnings)};
}

}  // namespace

absl::StatusOr<JointClipFile> ReadJointClip(const std::string& path,
                                            const ReadMotionOptions& options) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes,
                         ReadFile(path, options.limits.max_document_bytes));
  return WithContext(path, DecodeClip(path, bytes, options));
}

}  // namespace pleat
