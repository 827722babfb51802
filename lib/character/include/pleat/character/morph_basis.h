// The folds of a clip as morph targets, for programs that skin and morph and know nothing of Pleat
// (docs/method/prediction.md#folds-as-morph-targets).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/character_model.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/skin_weights.h"

namespace pleat {

inline constexpr int kMaxMorphTargets = 512;

struct MorphBasisOptions {
  // The number of targets, 1 to kMaxMorphTargets; 0: as many as max_error_m asks for.
  int num_targets = 0;
  // No vertex of any frame is further off than this; 0 asks for nothing. One of the two is needed.
  // The numbers of targets that are tried are those of the table.
  double max_error_m = 0;
  int max_basis_frames = 400;  // evenly spread ones are used of a longer clip
};

// How far the vertices of all frames are from those of the model with so many targets.
struct MorphBasisError {
  int num_targets = 0;
  double rms_m = 0, max_m = 0;
};

// skin(rest + sum_k weights(t, k) * target_k) is frame t of the clip.
struct MorphBasis {
  // 3V x N, meters, in the rest pose: target 0 is what all frames have, the others are the
  // principal components of the clip. Float32, as files hold them.
  Eigen::MatrixXf targets;
  Eigen::MatrixXf weights;  // T x N, from 0 to 1; of target 0 always 1
  // With no targets, with 1, 2, 3, 4, 6, 8, 12, ... and with N.
  std::vector<MorphBasisError> errors;
};

// Evaluates `track` with `model` and brings the mesh of every frame back into the rest pose of the
// skin with `weights` (those of the model's rig, or other ones that a file holds). kInvalidArgument
// when the track does not fit the model or the options ask for nothing, kFailedPrecondition when
// kMaxMorphTargets, or as many as the clip has frames, do not reach max_error_m; it says what they
// reach.
absl::StatusOr<MorphBasis> ComputeMorphBasis(const std::shared_ptr<const CharacterModel>& model,
                                             const SkinWeights& weights, const PoseTrack& track,
                                             const MorphBasisOptions& options,
                                             const Progress& progress = {});

}  // namespace pleat
