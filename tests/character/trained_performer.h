// One small performer and a character trained on it, shared by the tests of this folder.
#pragma once

#include <memory>

#include "pleat/character/evaluate.h"
#include "pleat/character/train_character.h"
#include "pleat/performer/performer.h"

namespace pleat {

inline const Performer& SmallPerformer() {
  static const Performer performer =
      GeneratePerformer({.num_frames = 60, .num_vertices = 900}).value();
  return performer;
}

inline TrainOptions FastTrainOptions() { return {.learner = LearnerChoice::kGp}; }
inline EvaluateOptions FastEvaluateOptions(EvaluationProtocol protocol) {
  EvaluateOptions options;
  options.protocol = protocol;
  options.train = FastTrainOptions();
  return options;
}

inline std::shared_ptr<const CharacterModel> SmallCharacter() {
  static const std::shared_ptr<const CharacterModel> model =
      TrainCharacter({SmallPerformer().sequence}, FastTrainOptions()).value();
  return model;
}

}  // namespace pleat
