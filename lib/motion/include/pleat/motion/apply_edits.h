// Edits of motions (docs/method/motion.md#edits). The list of an edited file is applied in order.
#pragma once

#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/formats/edited_motion_file.h"
#include "pleat/formats/motion_file.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

inline constexpr int kMaxEditedFrames = 100'000;

// Applies one edit, which CheckEdit accepts (asserted). kInvalidArgument names a joint that is not
// there and what an edit cannot do with this motion, kResourceExhausted the limit on frames.
absl::StatusOr<Motion> ApplyEdit(const Skeleton& skeleton, Motion motion, const MotionEdit& edit);

// Reads the source of the history and applies all edits. Errors name the edit.
absl::StatusOr<Motion> ApplyHistory(const Skeleton& skeleton, const EditHistory& history,
                                    const MeshLimits& limits = {});

// Adds `edit` to the motion file `text`, whose skeleton is `skeleton`, and returns the new file.
absl::StatusOr<std::string> AddEdit(const Skeleton& skeleton, std::string_view text,
                                    MotionEdit edit, const MeshLimits& limits = {});
// Takes the last `count` edits away. Without any left the file is byte for byte what it was before
// the first. kInvalidArgument when there are fewer.
absl::StatusOr<std::string> UndoEdits(std::string_view text, int count,
                                      const MeshLimits& limits = {});

}  // namespace pleat
