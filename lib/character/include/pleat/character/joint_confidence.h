// Where on the body a pose is unlike the training: a confidence for every joint, which a picture
// can show. The one number of PoseEvaluator is about the pose as a whole.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "pleat/character/character_model.h"

namespace pleat {

// Fills `confidence` (J entries, 0..1) for the joints of poses[0]; poses as for
// PoseEvaluator::Evaluate.
//
//   c_j = max_i exp(-g/2 sum_d (x_d - x_id)^2),  d over the features of joint j
//
// with the rows x_i and the width g that the learner's kernel of poses has learned
// (docs/method/prediction.md#where-the-confidence-is-lost). It is 1 where some training frame has
// the joint as it is now. No kernel value of the whole pose is above that of any of its joints. The
// root is always 1, since no feature depends on it. The error is kInvalidArgument, as in Evaluate.
absl::Status JointConfidence(const CharacterModel& model, const std::vector<const Pose*>& poses,
                             std::vector<double>* confidence);

}  // namespace pleat
