// What training decides around its learners: the basis, refusals, shortcuts and the summary.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pleat/learner/detail_model.h"
#include "support/gplvm_data.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr int kFrames = 50, kFeatures = 8, kDetails = 18;

DetailModelOptions Options(Learner learner = Learner::kRidge) {
  DetailModelOptions options;
  options.learner = learner;
  return options;
}

class DetailModelTrainTest : public testing::Test {
 protected:
  absl::StatusOr<DetailModel> Train(const DetailModelOptions& options,
                                    DetailModelSummary* summary = nullptr) const {
    return TrainDetailModel(motion_.features, motion_.details, {0}, options, summary);
  }
  Eigen::VectorXd Predict(const DetailModel& model, int row) const {
    DetailModel::Workspace workspace;
    Eigen::VectorXf detail(model.num_details());
    model.Predict(motion_.features.row(row).transpose(), &workspace, detail);
    return detail.cast<double>();
  }

  const SyntheticMotion motion_ = MakeSyntheticMotion(kFrames, kFeatures, kDetails, 3);
};

TEST_F(DetailModelTrainTest, TheSummaryMeasuresTheModelOnItsOwnFrames) {
  DetailModelOptions options = Options(Learner::kGp);
  options.rounding = 0;
  options.pca_energy = 1;
  DetailModelSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel model, Train(options, &summary));
  double square = 0;
  for (int t = 0; t < kFrames; ++t) {
    square += (Predict(model, t) - motion_.details.row(t).transpose()).squaredNorm();
  }
  const double rms = std::sqrt(square / (kFrames * kDetails));
  EXPECT_NEAR(summary.training_rms, rms, .2 * rms);  // float32 and the rounded basis
  EXPECT_EQ(summary.num_components, model.num_components());
}

TEST_F(DetailModelTrainTest, EnergyAndCapDecideTheComponents) {
  DetailModelOptions options = Options();
  options.max_components = 2;
  DetailModelSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel capped, Train(options, &summary));
  EXPECT_EQ(capped.num_components(), 2);
  EXPECT_LT(summary.kept_energy, 1);
  options.max_components = 100;
  options.pca_energy = .5;
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel half, Train(options, &summary));
  EXPECT_GE(summary.kept_energy, .5);
  EXPECT_LT(half.num_components(), 6);
}

TEST_F(DetailModelTrainTest, TheOutputMapIsAppliedToEveryPrediction) {
  const Eigen::MatrixXd map = RandomMatrix(7, kDetails, 5);
  DetailModelOptions options = Options();
  options.rounding = 0;
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel plain, Train(options));
  options.output_map = [&map](const Eigen::MatrixXd& columns) {
    return Eigen::MatrixXd(map * columns);
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel mapped, Train(options));
  EXPECT_EQ(mapped.num_details(), 7);
  for (const int t : {0, 17, 49}) {
    const Eigen::VectorXd expected = map * Predict(plain, t);
    EXPECT_LT((Predict(mapped, t) - expected).norm(), 1e-3 * expected.norm()) << t;
  }
}

TEST_F(DetailModelTrainTest, ATrainedGpIsTakenAsItIs) {
  DetailModelOptions options = Options(Learner::kGp);
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel first, Train(options));
  options.trained_gp = &first.stages().front();
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel second, Train(options));
  for (const int t : {0, 25}) EXPECT_EQ(Predict(first, t), Predict(second, t));
  options.max_components = 1;
  EXPECT_THAT(Train(options), HasStatus(absl::StatusCode::kInvalidArgument,
                                        "the trained GP has other inputs or outputs"));
}

TEST_F(DetailModelTrainTest, DetailsThatNeverChangeAreLearnedAsTheyAre) {
  const Eigen::MatrixXd constant = Eigen::VectorXd::Ones(kFrames) * RandomMatrix(1, kDetails, 7);
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel model,
                             TrainDetailModel(motion_.features, constant, {0}, Options()));
  EXPECT_EQ(model.num_components(), 1);
  EXPECT_LT((Predict(model, 11) - constant.row(0).transpose()).norm(), 1e-5);
}

TEST_F(DetailModelTrainTest, RegionsThatShareTheBodyAddUpToTheWhole) {
  // Two regions with the same features and shares that sum to one.
  DetailModelOptions options = Options(Learner::kRegional);
  std::vector<int> all(kFeatures);
  for (int i = 0; i < kFeatures; ++i) all[i] = i;
  const Eigen::VectorXd weights = (RandomMatrix(kDetails, 1, 8).array().sin() * .5 + .5).col(0);
  std::vector<int> rows(kDetails);
  for (int i = 0; i < kDetails; ++i) rows[i] = i;
  options.regions = {{.rows = rows, .weights = weights, .feature_sets = {all}},
                     {.rows = rows, .weights = 1 - weights.array(), .feature_sets = {all}}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel model, Train(options));
  double square = 0;
  for (int t = 0; t < kFrames; ++t) {
    square += (Predict(model, t) - motion_.details.row(t).transpose()).squaredNorm();
  }
  const double spread =
      (motion_.details.rowwise() - motion_.details.colwise().mean()).squaredNorm();
  EXPECT_LT(square, .01 * spread);
}

TEST_F(DetailModelTrainTest, DataThatDoNotAgreeAreToldWithTheirSizes) {
  EXPECT_THAT(TrainDetailModel(motion_.features.topRows(49), motion_.details, {0}, Options()),
              HasStatus(absl::StatusCode::kInvalidArgument,
                        "a detail model needs at least two frames of features and details, got 49 "
                        "x 8 features and 50 x 18 details"));
  EXPECT_FALSE(
      TrainDetailModel(motion_.features.topRows(1), motion_.details.topRows(1), {0}, Options())
          .ok());
  Eigen::MatrixXd bad = motion_.details;
  bad(3, 4) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(TrainDetailModel(motion_.features, bad, {0}, Options()),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not finite")));
  EXPECT_FALSE(TrainDetailModel(motion_.features, motion_.details, {0, 50}, Options()).ok());
  EXPECT_FALSE(TrainDetailModel(motion_.features, motion_.details, {1}, Options()).ok());
}

TEST_F(DetailModelTrainTest, OptionsOutOfRangeAreNamed) {
  DetailModelOptions energy = Options();
  energy.pca_energy = 1.5;
  EXPECT_THAT(Train(energy),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("an energy in (0, 1]")));
  DetailModelOptions fade = Options();
  fade.fade_confidence = -.1;
  EXPECT_THAT(Train(fade), HasStatus(absl::StatusCode::kInvalidArgument,
                                     HasSubstr("a fading confidence in [0, 1]")));
  EXPECT_THAT(Train(Options(Learner::kRegional)),
              HasStatus(absl::StatusCode::kInvalidArgument, "the regional learner needs regions"));
  DetailModelOptions region = Options(Learner::kRegional);
  region.regions = {
      {.rows = {0, 1, 2}, .weights = Eigen::VectorXd::Ones(5), .feature_sets = {{0, 1}}}};
  EXPECT_THAT(Train(region), HasStatus(absl::StatusCode::kInvalidArgument,
                                       HasSubstr("a region has 5 weights for 3 details")));
  region.regions[0].weights = Eigen::VectorXd::Ones(3);
  region.regions[0].rows = {0, 1, 18};
  EXPECT_THAT(Train(region),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("ascend below 18")));
  region.regions[0].rows = {0, 1, 2};
  region.num_part_regions = 2;
  EXPECT_THAT(Train(region),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("2 of 1 regions")));
  region.num_part_regions = 0;
  region.num_pose_features = 9;
  EXPECT_THAT(Train(region), HasStatus(absl::StatusCode::kInvalidArgument,
                                       HasSubstr("9 features of the pose among 8")));
}

}  // namespace
}  // namespace pleat
