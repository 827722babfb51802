// Evaluation of the whole pipeline on held-out frames (docs/method/evaluation.md#rules; Figure 5 of
// the paper).
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
  kReconstruct,  // trains and tests on all frames (the graphs of the paper)
  kEvery5th,     // tests the frames t with t mod 5 = 2
  kBlocks10,     // tests blocks of 10 frames that begin at t = 15, 50, 85, ... while t < T - 5
  kLast30,       // tests the last 30 % of the frames
  kCross,        // trains on one clip and tests on another of the same topology
};
absl::StatusOr<EvaluationProtocol> ParseEvaluationProtocol(const std::string& name);
const char* EvaluationProtocolName(EvaluationProtocol protocol);

struct FrameSplit {
  std::vector<int> train, test;  // ascending frame indices
};
// Splits the frames of one clip by `protocol`. kInvalidArgument when the sequence is too short to
// leave frames on both sides.
absl::StatusOr<FrameSplit> SplitFrames(EvaluationProtocol protocol, int num_frames);

struct EvaluateOptions {
  EvaluationProtocol protocol = EvaluationProtocol::kBlocks10;
  TrainOptions train;  // the learner "auto" chooses by validation inside the training frames
  TrainResources resources;
  // The learners that are measured. "auto" is not allowed; the chosen learner is always measured.
  std::vector<LearnerChoice> learners = {LearnerChoice::kSgplvm, LearnerChoice::kGp,
                                         LearnerChoice::kRegional};
  bool measure_baselines = true;
  // For the protocol "cross": further clips to train on, with the connectivity of the first.
  std::vector<MeshSequence> more_training_clips;
  std::function<double()> clock_seconds;  // for EvaluateReport::seconds; without it they are 0
};

struct EvaluateReport {
  std::string protocol;
  double diagonal_m = 0;  // bounding-box diagonal of the first frame, meters
  int num_train_frames = 0, num_test_frames = 0;
  std::string learner;           // the chosen learner, whose errors `hybrid` holds
  LearnerValidation validation;  // what it was chosen by
  int num_control_vertices = 0;
  ErrorSummary skinned, hybrid;
  std::map<std::string, ErrorSummary> baselines;  // "zero", "mean", "nearest", "ridge"
  std::map<std::string, ErrorSummary> learners;   // by their names, see LearnerNames()
  std::map<std::string, double> seconds;          // "read", "rig", "fit", "learn", "predict"
  TrainOptions options;
  std::vector<int> test_frames;
};

// Everything that is learned (the rig, the control mesh, the details, the learner and its choice)
// sees the training frames only. The poses of the test frames are fitted to the test meshes with
// the rig fixed, and the full mesh that is predicted from them is compared with the test mesh.
// `test_sequence` is the second clip of the protocol "cross" and absent in all others.
// kInvalidArgument names an option or clip that does not fit; other errors are those of training.
absl::StatusOr<EvaluateReport> EvaluateCharacter(const MeshSequence& sequence,
                                                 const std::optional<MeshSequence>& test_sequence,
                                                 const EvaluateOptions& options,
                                                 const Progress& progress = {});

}  // namespace pleat
