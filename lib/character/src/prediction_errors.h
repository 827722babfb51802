// Measures the errors of predicted test frames, whatever predicts them.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "baselines.h"
#include "pleat/base/progress.h"
#include "pleat/character/character_model.h"
#include "pleat/mesh/error_metrics.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"

namespace pleat {

// What the predictions are compared with.
struct TestSide {
  MeshSequence sequence;    // the whole clip that holds the test frames
  PoseTrack track;          // its poses, fitted with the trained rig
  std::vector<int> frames;  // test frames, ascending
};

// Measures the model, or with `skinned_only` its rig alone. diagonal_m: what percentages refer to.
absl::StatusOr<ErrorSummary> MeasureModel(const std::shared_ptr<const CharacterModel>& model,
                                          const TestSide& test, double diagonal_m,
                                          bool skinned_only, const Progress& progress);

// Measures a baseline. It predicts the details of the control vertices; upsampling and skinning are
// the model's own.
absl::StatusOr<ErrorSummary> MeasureBaseline(const DetailPredictor& predictor,
                                             const CharacterModel& model, const TestSide& test,
                                             double diagonal_m, const Progress& progress);

}  // namespace pleat
