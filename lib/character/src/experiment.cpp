#include "pleat/character/experiment.h"

#include <array>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "evaluation_steps.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr std::array<std::pair<Experiment, const char*>, 4> kExperiments = {{
    {Experiment::kFullVsFine, "full-vs-fine"},
    {Experiment::kRepresentations, "representations"},
    {Experiment::kResolutions, "resolutions"},
    {Experiment::kSkinnedVsHybrid, "skinned-vs-hybrid"},
}};

std::vector<ExperimentVariant> FullVsFine(const TrainOptions& base) {
  // All components are kept, so that neither side wins by where its energy is cut.
  TrainOptions fine = base;
  fine.deformation = DetailBase::kSkinned;
  fine.detail_energy = 1;
  fine.max_components = 1024;
  TrainOptions full = fine;
  full.deformation = DetailBase::kRoot;
  // The local axes of a vertex turn with its bones, and the turning of the bones is a part of the
  // deformation that is to be learned here.
  if (full.detail_axes == DetailAxes::kLocal) full.detail_axes = DetailAxes::kRoot;
  return {{"deformation", "fine (details)", fine}, {"deformation", "full deformation", full}};
}

std::vector<ExperimentVariant> Representations(const TrainOptions& base) {
  std::vector<ExperimentVariant> variants;
  for (const auto& [rotations, name] :
       {std::pair(RotationRepresentation::kExponentialMap, "exponential maps"),
        {RotationRepresentation::kEuler, "Euler angles"},
        {RotationRepresentation::kQuaternion, "quaternions"}}) {
    TrainOptions options = base;
    options.rotations = rotations;
    variants.push_back({"rotations", name, options});
  }
  for (const auto& [axes, coordinates, name] :
       {std::tuple(DetailAxes::kWorld, DetailCoordinates::kOffsets, "xyz (world axes)"),
        {DetailAxes::kRoot, DetailCoordinates::kOffsets, "root axes"},
        {DetailAxes::kLocal, DetailCoordinates::kOffsets, "local axes"},
        {DetailAxes::kWorld, DetailCoordinates::kDifferential, "differential (world axes)"}}) {
    TrainOptions options = base;
    options.detail_axes = axes;
    options.detail_coordinates = coordinates;
    variants.push_back({"details", name, options});
  }
  return variants;
}

std::vector<ExperimentVariant> Resolutions(const TrainOptions& base) {
  std::vector<ExperimentVariant> variants;
  for (const int percent : {100, 75, 50, 25, 10, 5}) {
    TrainOptions options = base;
    options.resolution_percent = percent;
    variants.push_back({"resolution", absl::StrCat(percent, " % of the vertices"), options});
  }
  return variants;
}

}  // namespace

absl::StatusOr<Experiment> ParseExperiment(const std::string& name) {
  for (const auto& [experiment, known] : kExperiments) {
    if (name == known) return experiment;
  }
  return absl::InvalidArgumentError(absl::StrCat("unknown experiment '", name, "'; choose one of ",
                                                 absl::StrJoin(ExperimentNames(), ", ")));
}

const char* ExperimentName(Experiment experiment) {
  for (const auto& [known, name] : kExperiments) {
    if (known == experiment) return name;
  }
  return "unknown";
}

std::vector<std::string> ExperimentNames() {
  std::vector<std::string> names;
  for (const auto& [experiment, name] : kExperiments) names.emplace_back(name);
  return names;
}

std::vector<ExperimentVariant> ExperimentVariants(Experiment experiment, const TrainOptions& base) {
  switch (experiment) {
    case Experiment::kFullVsFine:
      return FullVsFine(base);
    case Experiment::kRepresentations:
      return Representations(base);
    case Experiment::kResolutions:
      return Resolutions(base);
    case Experiment::kSkinnedVsHybrid:
      break;
  }
  return {{"hybrid", "hybrid", base}};
}

absl::StatusOr<ExperimentReport> RunExperiment(const MeshSequence& sequence,
                                               const std::optional<MeshSequence>& test_sequence,
                                               Experiment experiment,
                                               const EvaluateOptions& options,
                                               const Progress& progress) {
  EvaluateOptions measured = options;
  if (experiment != Experiment::kSkinnedVsHybrid) {
    measured.learners.clear();
    measured.measure_baselines = false;
  }
  PLEAT_ASSIGN_OR_RETURN(
      const EvaluationSetup setup,
      PrepareEvaluation(sequence, test_sequence, measured, progress.Stage("rig", 0, .2)));
  ExperimentReport report{.experiment = experiment, .rows = {}};
  const std::vector<ExperimentVariant> variants = ExperimentVariants(experiment, options.train);
  for (size_t i = 0; i < variants.size(); ++i) {
    const ExperimentRow* same = nullptr;
    for (const ExperimentRow& row : report.rows) {
      if (row.variant.options == variants[i].options) same = &row;
    }
    if (same) {
      EvaluateReport copy = same->report;
      report.rows.push_back({variants[i], std::move(copy)});
      continue;
    }
    const double count = static_cast<double>(variants.size());
    PLEAT_ASSIGN_OR_RETURN(
        EvaluateReport evaluated,
        EvaluateLearning(setup, variants[i].options, measured,
                         progress.Stage(variants[i].name, .2 + .8 * static_cast<double>(i) / count,
                                        .2 + .8 * static_cast<double>(i + 1) / count)));
    report.rows.push_back({variants[i], std::move(evaluated)});
  }
  return report;
}

}  // namespace pleat
