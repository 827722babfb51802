// The comparisons of the paper (section V, Figure 5): one character is learned in several ways and
// measured by one protocol (docs/method/evaluation.md#experiments-of-the-paper).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/evaluate.h"

namespace pleat {

enum class Experiment {
  kFullVsFine,       // learning all deformation or only details beyond skinning (Figure 5a)
  kRepresentations,  // representations of rotations and of details (Figure 5b)
  kResolutions,      // control meshes of 100, 75, 50, 25, 10 and 5 % of the vertices (Figure 5c)
  kSkinnedVsHybrid,  // what the details add to skinning, for every learner (second experiment)
};
absl::StatusOr<Experiment> ParseExperiment(const std::string& name);
const char* ExperimentName(Experiment experiment);
// The names of all experiments: "full-vs-fine" and so on.
std::vector<std::string> ExperimentNames();

struct ExperimentVariant {
  std::string group;  // variants of one group are compared with each other
  std::string name;
  TrainOptions options;
};

// Returns what is compared, starting from `base`. Only what is learned varies, never the rig or the
// poses.
std::vector<ExperimentVariant> ExperimentVariants(Experiment experiment, const TrainOptions& base);

struct ExperimentRow {
  ExperimentVariant variant;
  EvaluateReport report;  // a variant that is in two groups is measured once
};

struct ExperimentReport {
  Experiment experiment = Experiment::kSkinnedVsHybrid;
  std::vector<ExperimentRow> rows;  // in the order of ExperimentVariants
};

// Finds rig and poses once, on the training frames of the protocol; then it trains and measures
// every variant as EvaluateCharacter does, with the same errors. The learners and baselines of
// `options` are measured in kSkinnedVsHybrid only; all other experiments measure the learner of
// options.train.
absl::StatusOr<ExperimentReport> RunExperiment(const MeshSequence& sequence,
                                               const std::optional<MeshSequence>& test_sequence,
                                               Experiment experiment,
                                               const EvaluateOptions& options,
                                               const Progress& progress = {});

}  // namespace pleat
