#include "pleat/character/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/status_matchers.h"
#include "trained_performer.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr Experiment kAll[] = {Experiment::kFullVsFine, Experiment::kRepresentations,
                               Experiment::kResolutions, Experiment::kSkinnedVsHybrid};

const ExperimentRow& RowNamed(const ExperimentReport& report, const std::string& start) {
  for (const ExperimentRow& row : report.rows) {
    if (row.variant.name.rfind(start, 0) == 0) return row;
  }
  ADD_FAILURE() << "no row " << start;
  return report.rows.front();
}

TEST(ExperimentTest, NamesRoundTripAndUnknownIsRefused) {
  for (const Experiment experiment : kAll) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Experiment parsed,
                               ParseExperiment(ExperimentName(experiment)));
    EXPECT_EQ(parsed, experiment);
  }
  EXPECT_THAT(ExperimentNames(),
              ElementsAre("full-vs-fine", "representations", "resolutions", "skinned-vs-hybrid"));
  EXPECT_THAT(ParseExperiment("figure-9"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("full-vs-fine")));
}

TEST(ExperimentTest, VariantsAreValidAndLeaveRigAndPosesAlone) {
  for (const TrainOptions& base : {TrainOptions(), TrainOptions::Paper()}) {
    for (const Experiment experiment : kAll) {
      for (const ExperimentVariant& variant : ExperimentVariants(experiment, base)) {
        EXPECT_THAT(ValidateTrainOptions(variant.options), IsOk()) << variant.name;
        TrainOptions options = variant.options;  // with the fields that learning alone reads reset
        options.deformation = base.deformation;
        options.detail_axes = base.detail_axes;
        options.detail_coordinates = base.detail_coordinates;
        options.rotations = base.rotations;
        options.resolution_percent = base.resolution_percent;
        options.detail_energy = base.detail_energy;
        options.max_components = base.max_components;
        EXPECT_EQ(options, base) << variant.name;
      }
    }
  }
}

TEST(ExperimentTest, FineDetailsBeatTheFullDeformation) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const ExperimentReport report,
      RunExperiment(SmallPerformer().sequence, std::nullopt, Experiment::kFullVsFine,
                    FastEvaluateOptions(EvaluationProtocol::kBlocks10)));
  ASSERT_EQ(report.rows.size(), 2u);
  const EvaluateReport& fine = RowNamed(report, "fine").report;
  const EvaluateReport& full = RowNamed(report, "full").report;
  EXPECT_LT(fine.hybrid.mean_percent, full.hybrid.mean_percent);
  EXPECT_EQ(fine.skinned.mean_percent, full.skinned.mean_percent);
  EXPECT_EQ(fine.hybrid.frame_mean_percent.size(), fine.test_frames.size());
  EXPECT_TRUE(fine.baselines.empty());
}

TEST(ExperimentTest, RowsAreWhatAnEvaluationOfTheirOptionsGives) {
  const EvaluateOptions options = FastEvaluateOptions(EvaluationProtocol::kLast30);
  PLEAT_ASSERT_OK_AND_ASSIGN(const ExperimentReport report,
                             RunExperiment(SmallPerformer().sequence, std::nullopt,
                                           Experiment::kRepresentations, options));
  ASSERT_EQ(report.rows.size(), 7u);
  // The starting point is in both groups.
  EXPECT_EQ(RowNamed(report, "exponential").report.hybrid.mean_percent,
            RowNamed(report, "local").report.hybrid.mean_percent);
  for (const char* name : {"Euler", "differential"}) {
    EvaluateOptions alone = options;
    alone.train = RowNamed(report, name).variant.options;
    alone.learners.clear();
    PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluateReport expected,
                               EvaluateCharacter(SmallPerformer().sequence, std::nullopt, alone));
    EXPECT_EQ(RowNamed(report, name).report.hybrid.mean_percent, expected.hybrid.mean_percent);
  }
}

TEST(ExperimentTest, ResolutionsGoFromAllVerticesToFivePercent) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const ExperimentReport report,
      RunExperiment(SmallPerformer().sequence, std::nullopt, Experiment::kResolutions,
                    FastEvaluateOptions(EvaluationProtocol::kReconstruct)));
  ASSERT_EQ(report.rows.size(), 6u);
  for (size_t i = 1; i < 6; ++i) {
    EXPECT_LT(report.rows[i].report.num_control_vertices,
              report.rows[i - 1].report.num_control_vertices);
  }
  EXPECT_LT(report.rows[0].report.hybrid.mean_percent, report.rows[5].report.hybrid.mean_percent);
}

TEST(ExperimentTest, HybridIsMeasuredAgainstSkinningLearnersAndBaselines) {
  EvaluateOptions options = FastEvaluateOptions(EvaluationProtocol::kBlocks10);
  options.learners = {LearnerChoice::kRidge, LearnerChoice::kGp};
  PLEAT_ASSERT_OK_AND_ASSIGN(const ExperimentReport report,
                             RunExperiment(SmallPerformer().sequence, std::nullopt,
                                           Experiment::kSkinnedVsHybrid, options));
  ASSERT_EQ(report.rows.size(), 1u);
  const EvaluateReport& row = report.rows[0].report;
  EXPECT_LT(row.hybrid.mean_percent, row.skinned.mean_percent);
  EXPECT_EQ(row.learners.size(), 2u);
  // The ridge learner is the ridge baseline, but that its basis drops components and that it fades.
  EXPECT_NEAR(row.learners.at("ridge").mean_percent, row.baselines.at("ridge").mean_percent,
              .1 * row.baselines.at("ridge").mean_percent);
  for (const ErrorSummary* error : {&row.skinned, &row.hybrid}) {
    EXPECT_GT(error->num_motion_frames, 0);
    EXPECT_GT(error->num_jitter_frames, 0);
    EXPECT_GT(error->jitter_mm, 0);
    EXPECT_GT(error->truth_jitter_mm, 0);
  }
}

}  // namespace
}  // namespace pleat
