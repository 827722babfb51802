// Finds the frame of a sequence that is rigged, and how the character stands in it.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/rigging/auto_rig.h"
#include "pleat/rigging/body_volume.h"
#include "pleat/rigging/embedding.h"

namespace pleat {

struct FrameEmbedding {
  int frame = -1;
  std::shared_ptr<const BodyVolume> volume;
  Eigen::Matrix3d upright_from_input = Eigen::Matrix3d::Identity();
  Embedding embedding;
  // Found only with forearms that point anywhere, or turned over and not trusted: a beast may come
  // as near to a human, so feet or knees must confirm it.
  bool is_tentative = false;
};

// Rigs above this residual are doubtful.
inline constexpr double kDoubtfulResidual = .1;

// Returns the first frame when it is trusted, else the best of a few, looked at on a coarse grid
// first; and when none of them is trusted as it stands, they are also tried lying and upside down
// (docs/method/rig.md#rest-frame). The error is kFailedPrecondition, with what to do, when no human
// fits, and kCancelled. Fills summary->num_frames_tried.
absl::StatusOr<FrameEmbedding> FindRestFrame(const MeshSequence& sequence,
                                             const AutoRigOptions& options, AutoRigSummary* summary,
                                             const Progress& progress);

// Says what a user can do about a sequence that cannot be rigged.
inline constexpr char kRigAdvice[] =
    "choose another rest frame, one that stands upright with arms and legs apart, place some "
    "joints by hand (pleat rig --at leftHand=x,y,z), or bring your own rig";

}  // namespace pleat
