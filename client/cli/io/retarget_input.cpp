#include "cli/io/retarget_input.h"

#include <utility>

#include "absl/strings/match.h"
#include "cli/io/frame_rate.h"
#include "pleat/base/status.h"
#include "pleat/formats/joint_clip_reader.h"
#include "pleat/motion/default_joint_map.h"

namespace pleat {
namespace {

// A clip of the character's own joints and rest pose needs no retargeting, and a GLB without such
// joints may be a mesh sequence.
absl::StatusOr<bool> IsForeign(const RetargetInput& input, const CharacterModel& model,
                               const ReadMotionOptions& options) {
  if (input.required || !input.map.empty()) return true;
  if (!absl::EndsWithIgnoreCase(input.source, ".bvh")) return false;
  const absl::StatusOr<Motion> own = ReadMotion(input.source, model.skeleton(), options);
  return !own.ok() && absl::IsInvalidArgument(own.status());
}

}  // namespace

absl::StatusOr<std::optional<Motion>> RetargetForeignClip(const RetargetInput& input,
                                                          const CharacterModel& model,
                                                          RetargetSummary* summary) {
  ReadMotionOptions options;
  if (!input.fps.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.frame_rate, ParseFrameRate(input.fps));
  }
  PLEAT_ASSIGN_OR_RETURN(const bool is_foreign, IsForeign(input, model, options));
  if (!is_foreign) return std::optional<Motion>();
  PLEAT_ASSIGN_OR_RETURN(JointClipFile file, ReadJointClip(input.source, options));
  const Skeleton& skeleton = model.skeleton();
  summary->source = input.source;
  summary->num_frames = file.clip.num_frames();
  summary->num_joints = file.clip.num_joints();
  summary->fps = file.clip.fps;
  if (input.map.empty()) {
    PLEAT_ASSIGN_OR_RETURN(summary->map,
                           WithContext(input.source, MakeJointMap(file.clip, skeleton)));
  } else {
    PLEAT_ASSIGN_OR_RETURN(summary->map, ReadJointMap(input.map));
  }
  PLEAT_ASSIGN_OR_RETURN(
      PoseTrack track,
      WithContext(input.source, Retarget(file.clip, summary->map, skeleton, {}, &summary->report)));
  if (input.clean_feet) {
    summary->feet.emplace();
    PLEAT_ASSIGN_OR_RETURN(
        track, CleanFeet(skeleton, track, summary->report.contacts, {}, &*summary->feet));
  }
  std::optional<Motion> motion(std::in_place);
  motion->track = std::move(track);
  motion->warnings = std::move(file.warnings);
  for (const std::string& warning : summary->report.warnings) motion->warnings.push_back(warning);
  return motion;
}

}  // namespace pleat
