#include "pleat/formats/motion_reader.h"

#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "clip_motion.h"
#include "glb_joints.h"
#include "gltf_file.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/formats/bvh.h"
#include "sequence_inputs.h"

namespace pleat {
namespace {

bool IsGlb(std::string_view bytes) { return bytes.starts_with("glTF"); }

absl::StatusOr<Motion> MotionOfBvh(std::string_view text, const Skeleton& skeleton,
                                   const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(BvhFile file, DecodeBvh(text, limits));
  PLEAT_ASSIGN_OR_RETURN(Motion motion, MotionFromClip(file.clip, skeleton));
  motion.warnings.insert(motion.warnings.begin(), file.warnings.begin(), file.warnings.end());
  return motion;
}

absl::StatusOr<Motion> MotionOfGlb(std::string_view bytes, const Skeleton& skeleton,
                                   const ReadMotionOptions& options) {
  InputReport report;
  PLEAT_ASSIGN_OR_RETURN(
      const std::optional<JointClip> clip,
      DecodeGlbJoints(bytes, skeleton, options.frame_rate, options.limits, &report));
  if (!clip) {
    return absl::InvalidArgumentError(absl::StrCat(
        "no skin of the file has all joints of the character, which are ",
        absl::StrJoin(skeleton.joints(), ", ",
                      [](std::string* out, const Joint& joint) { out->append(joint.name); })));
  }
  PLEAT_ASSIGN_OR_RETURN(Motion motion, MotionFromClip(*clip, skeleton));
  for (const InputNote& note : report.notes) motion.warnings.push_back(note.text);
  return motion;
}

absl::StatusOr<Motion> DecodeAnyMotion(const std::string& path, std::string_view bytes,
                                       const Skeleton& skeleton, const ReadMotionOptions& options) {
  if (IsBvhText(bytes)) return MotionOfBvh(bytes, skeleton, options.limits);
  if (IsGlb(bytes)) return MotionOfGlb(bytes, skeleton, options);
  const bool is_motion = bytes.find("pleat.motion/") != std::string_view::npos;
  if (!is_motion && IsGltfText(bytes)) {
    PLEAT_ASSIGN_OR_RETURN(const std::string packed, PackGltf(bytes, path, options.limits));
    return MotionOfGlb(packed, skeleton, options);
  }
  if (LowerExtension(path) == ".bvh") return MotionOfBvh(bytes, skeleton, options.limits);
  return DecodeMotion(bytes, skeleton, options.limits);
}

}  // namespace

absl::StatusOr<Motion> ReadMotion(const std::string& path, const Skeleton& skeleton,
                                  const ReadMotionOptions& options) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes,
                         ReadFile(path, options.limits.max_document_bytes));
  return WithContext(path, DecodeAnyMotion(path, bytes, skeleton, options));
}

bool HoldsMotion(const std::string& path, const Skeleton& skeleton,
                 const ReadMotionOptions& options) {
  const std::string ending = LowerExtension(path);
  if (ending == ".json" || ending == ".bvh") return true;
  if (ending != ".glb" && ending != ".gltf") return false;
  MeshLimits limits = options.limits;
  limits.max_file_bytes = limits.max_document_bytes;  // larger ones are mesh sequences
  const absl::StatusOr<std::string> bytes = ReadGltfBytes(path, limits);
  if (!bytes.ok()) return false;
  InputReport report;
  const absl::StatusOr<std::optional<JointClip>> clip =
      DecodeGlbJoints(*bytes, skeleton, options.frame_rate, options.limits, &report);
  return clip.ok() && clip->has_value() && (*clip)->num_frames() > 1;
}

}  // namespace pleat
