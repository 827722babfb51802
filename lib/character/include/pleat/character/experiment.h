// The paper's comparisons: one character learned in several ways, measured by one protocol (the
// paper, section V, Figure 5; docs/method/evaluation.md#experiments-of-the-paper).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/evaluate.h"

namespace pleat {

enum class Experiment {
  kFullVsFine,       // all deformation against details beyond skinning (Figure 5a)
  kRepresentations,  // of rotations and of details (Figure 5b)
  kResolutions,      // of the control mesh: 100, 75, 50, 25, 10, 5 % of the vertices (Figure 5c)
  kSkinnedVsHybrid,  // what the details add to skinning, for every learner (second experiment)
};
absl::StatusOr<Experiment> ParseExperiment(const std::string& name);
const char* ExperimentName(Experiment experiment);
// "full-vs-fine", ...
std::vector<std::string> ExperimentNames();

struct ExperimentVariant {
  std::string group;  // variants of one group are compared with each other
  std::string name;
  TrainOptions options;
};

// What is compared, starting from `base`: only what is learned varies, never rig and poses.
std::vector<ExperimentVariant> ExperimentVariants(Experiment experiment, const TrainOptions& base);

struct ExperimentRow {
  ExperimentVariant variant;
  EvaluateReport report;  // a variant that is in two groups is measured once
};

struct ExperimentReport {
  Experiment experiment = Experiment::kSkinnedVsHybrid;
  std::vector<ExperimentRow> rows;  // in the order of ExperimentVariants
};

// Rig and poses are found once, on the training frames of the protocol; then every variant is
// trained and measured as EvaluateCharacter does. Of `options`, learners and baselines are measured
// in kSkinnedVsHybrid only; elsewhere the learner of `options.train` alone.
absl::StatusOr<ExperimentReport> RunExperiment(const MeshSequence& sequence,
                                               const std::optional<MeshSequence>& test_sequence,
                                               Experiment experiment,
                                               const EvaluateOptions& options,
                                               const Progress& progress = {});

}  // namespace pleat
