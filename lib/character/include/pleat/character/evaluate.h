// Held-out evaluation of the whole pipeline (docs/method/evaluation.md#rules; the paper's Figure
// 5).
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/train_character.h"
#include "pleat/mesh/error_metrics.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

enum class EvaluationProtocol {
  kReconstruct,  // train and test on all frames (the paper's graphs)
  kEvery5th,     // test t with t mod 5 = 2
  kBlocks10,     // test blocks of 10 frames from t = 15, 50, 85, ... while t < T - 5
  kLast30,       // test the last 30 %
  kCross,        // train on clip A, test on clip B of the same topology
};
absl::StatusOr<EvaluationProtocol> ParseEvaluationProtocol(const std::string& name);
const char* EvaluationProtocolName(EvaluationProtocol protocol);

struct FrameSplit {
  std::vector<int> train, test;  // ascending frame indices
};
// kInvalidArgument when the sequence is too short to leave frames on both sides.
absl::StatusOr<FrameSplit> SplitFrames(EvaluationProtocol protocol, int num_frames);

struct EvaluateOptions {
  EvaluationProtocol protocol = EvaluationProtocol::kBlocks10;
  TrainOptions train;  // learner auto chooses by validation inside the training frames
  TrainResources resources;
  // Which learners are measured (not auto); the chosen one is always among them.
  std::vector<LearnerChoice> learners = {LearnerChoice::kSgplvm, LearnerChoice::kGp,
                                         LearnerChoice::kRegional};
  bool measure_baselines = true;
  // Protocol cross: further clips to train on, of the connectivity of the first.
  std::vector<MeshSequence> more_training_clips;
  std::function<double()> clock_seconds;  // for EvaluateReport::seconds; absent = zeros
};

struct EvaluateReport {
  std::string protocol;
  double diagonal_m = 0;
  int num_train_frames = 0, num_test_frames = 0;
  std::string learner;           // the one behind `hybrid`
  LearnerValidation validation;  // that chose it
  int num_control_vertices = 0;
  ErrorSummary skinned, hybrid;
  std::map<std::string, ErrorSummary> baselines;  // "zero", "mean", "nearest", "ridge"
  std::map<std::string, ErrorSummary> learners;   // by name, LearnerNames()
  std::map<std::string, double> seconds;          // "read", "rig", "fit", "learn", "predict"
  TrainOptions options;
  std::vector<int> test_frames;
};

// Everything that is learned (rig, control mesh, details, learner and its choice) sees the training
// frames only; poses of test frames are fitted to the test meshes with the rig fixed; then the full
// mesh is predicted and compared. `test_sequence` is the second clip of protocol cross.
absl::StatusOr<EvaluateReport> EvaluateCharacter(const MeshSequence& sequence,
                                                 const std::optional<MeshSequence>& test_sequence,
                                                 const EvaluateOptions& options,
                                                 const Progress& progress = {});

}  // namespace pleat
