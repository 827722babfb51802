// What must hold for every learner, whatever the motion: what does not matter, what a query mixes
// and how it fades, and data that say little or nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "learner_variants.h"
#include "pleat/base/random.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr int kNumFrames = 80, kNumFeatures = 8, kNumDetails = 24;

struct Prediction {
  Eigen::MatrixXd details;      // M x D_M
  Eigen::VectorXd confidences;  // M
};

Prediction PredictAll(const DetailModel& model, const Eigen::MatrixXd& features) {
  Prediction result{Eigen::MatrixXd(features.rows(), model.num_details()),
                    Eigen::VectorXd(features.rows())};
  DetailModel::Workspace workspace;
  Eigen::VectorXf detail(model.num_details());
  for (Eigen::Index t = 0; t < features.rows(); ++t) {
    result.confidences[t] = model.Predict(features.row(t).transpose(), &workspace, detail);
    result.details.row(t) = detail.cast<double>().transpose();
  }
  return result;
}

// RMS distance of the details from their mean.
double Spread(const Eigen::MatrixXd& details) {
  return std::sqrt((details.rowwise() - details.colwise().mean()).squaredNorm() /
                   static_cast<double>(details.size()));
}

double Rms(const Eigen::MatrixXd& difference) {
  return std::sqrt(difference.squaredNorm() / static_cast<double>(difference.size()));
}

class DetailModelPropertiesTest : public testing::TestWithParam<LearnerVariant> {
 protected:
  bool is_linear() const { return GetParam().learner == Learner::kRidge; }
  DetailModelOptions Options(const SyntheticMotion& motion) const {
    DetailModelOptions options =
        WithRegions(SmallOptions(GetParam().learner, GetParam().back_constraints), motion);
    options.rounding = 1e-5;
    return options;
  }
  DetailModel Train(const SyntheticMotion& motion, std::vector<int> clip_starts = {0}) const {
    return TrainDetailModel(motion.features, motion.details, clip_starts, Options(motion)).value();
  }

  const SyntheticMotion motion_ = MakeSyntheticMotion(kNumFrames, kNumFeatures, kNumDetails, 4);
  // Near the training, but not in it.
  const Eigen::MatrixXd queries_ =
      motion_.features.middleRows(20, 30) + .05 * RandomMatrix(30, kNumFeatures, 5);
};

INSTANTIATE_TEST_SUITE_P(Learners, DetailModelPropertiesTest, testing::ValuesIn(kVariants),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(DetailModelPropertiesTest, TrainingPosesGetTheirDetailsWithinTheNoise) {
  SyntheticMotion noisy = motion_;
  const double noise = .1 * Spread(motion_.details);
  noisy.details += noise * RandomMatrix(kNumFrames, kNumDetails, 6);
  const Prediction learned = PredictAll(Train(noisy), motion_.features);
  if (is_linear()) {  // the truth is not
    EXPECT_LT(Rms(learned.details - motion_.details), .6 * Spread(motion_.details));
  } else {
    // Nearer to the truth than what was seen: the noise is not learned.
    EXPECT_LT(Rms(learned.details - motion_.details), noise);
    EXPECT_LT(Rms(learned.details - noisy.details), 1.2 * noise);
  }
  EXPECT_GT(learned.confidences.minCoeff(), .7);
}

// A pose half way between two frames of a smooth motion has nearly the detail half way between.
TEST_P(DetailModelPropertiesTest, BetweenTwoFramesTheDetailIsBetweenTheirs) {
  const Eigen::Index n = kNumFrames - 1;
  const Prediction ends = PredictAll(Train(motion_), motion_.features);
  const Prediction middle = PredictAll(
      Train(motion_), .5 * (motion_.features.topRows(n) + motion_.features.bottomRows(n)));
  const Eigen::MatrixXd mean = .5 * (ends.details.topRows(n) + ends.details.bottomRows(n));
  EXPECT_LT(Rms(middle.details - mean), .02 * Spread(motion_.details));
  EXPECT_GT(middle.confidences.minCoeff(), .7);
}

TEST_P(DetailModelPropertiesTest, OriginAndUnitOfPosesAndDetailsDoNotMatter) {
  const Prediction expected = PredictAll(Train(motion_), queries_);
  const Eigen::RowVectorXd pose_shift = 3 * RandomMatrix(1, kNumFeatures, 7);
  const Eigen::RowVectorXd detail_shift = RandomMatrix(1, kNumDetails, 8);
  SyntheticMotion moved = motion_;
  moved.features = (20 * motion_.features).rowwise() + pose_shift;
  moved.details = (1e-3 * motion_.details).rowwise() + detail_shift;  // millimeters to meters
  const Prediction found = PredictAll(Train(moved), (20 * queries_).rowwise() + pose_shift);
  const Eigen::MatrixXd back = 1e3 * (found.details.rowwise() - detail_shift);
  // Only rounding differs, but the optimizers' paths carry it on.
  EXPECT_LT(Rms(back - expected.details), .03 * Spread(motion_.details));
  EXPECT_LT((found.confidences - expected.confidences).cwiseAbs().maxCoeff(), .05);
}

TEST_P(DetailModelPropertiesTest, OrderOfClipsDoesNotMatter) {
  const int first = 30;
  SyntheticMotion exchanged = motion_;
  exchanged.features << motion_.features.bottomRows(kNumFrames - first),
      motion_.features.topRows(first);
  exchanged.details << motion_.details.bottomRows(kNumFrames - first),
      motion_.details.topRows(first);
  const Prediction expected = PredictAll(Train(motion_, {0, first}), queries_);
  const Prediction found = PredictAll(Train(exchanged, {0, kNumFrames - first}), queries_);
  EXPECT_LT(Rms(found.details - expected.details), .03 * Spread(motion_.details));
  EXPECT_LT((found.confidences - expected.confidences).cwiseAbs().maxCoeff(), .05);
}

// What is below the fading confidence is scaled by 3 t^2 - 2 t^3 of its share t of it, all else
// stays to the bit.
TEST_P(DetailModelPropertiesTest, FadingIsTheSmoothStepOfTheConfidence) {
  if (GetParam().learner == Learner::kRegional) GTEST_SKIP() << "the regional learner never fades";
  const DetailModel faded = Train(motion_);
  DetailModelParameters parameters = faded.parameters();
  parameters.fade_confidence = 0;
  const DetailModel plain = DetailModel::FromParameters(parameters).value();
  const GpRegression& stage = faded.stages().front();
  DetailModel::Workspace workspace;
  GpRegression::Workspace stage_workspace;
  Eigen::VectorXf a(faded.num_components()), b(faded.num_components());
  Eigen::VectorXd mean(stage.num_outputs());
  const Eigen::VectorXd start = motion_.features.row(10).transpose();
  const Eigen::VectorXd direction = RandomMatrix(kNumFeatures, 1, 9).normalized();
  int num_whole = 0, num_faded = 0;
  for (double distance = .05; distance < 200; distance *= 1.05) {
    const Eigen::VectorXd row = start + distance * direction;
    double variance = 0;
    stage.Predict(row, 0, &stage_workspace, mean, &variance);
    const double t = std::clamp(1 - variance / stage.prior_variance(), 0.0, 1.0) / .3;
    EXPECT_EQ(faded.PredictCoefficients(row, &workspace, a),
              plain.PredictCoefficients(row, &workspace, b));
    if (t >= 1) {
      EXPECT_EQ(a, b);
      ++num_whole;
    } else {
      const auto expected = static_cast<float>(t * t * (3 - 2 * t)) * b;
      EXPECT_LT((a - expected).norm(), 1e-5f * b.norm());
      num_faded += t > 0;
    }
  }
  EXPECT_GT(num_whole, 5);
  EXPECT_GT(num_faded, 2);
}

TEST_P(DetailModelPropertiesTest, ManyFramesAreLearnedThroughFewRows) {
  const SyntheticMotion many = MakeSyntheticMotion(240, kNumFeatures, kNumDetails, 4);
  DetailModelOptions options = Options(many);
  options.gp.max_rows = options.regional.max_rows = options.max_latents = 60;
  options.regional.max_exact_rows = 60;
  options.gp.max_hyperparameter_rows = options.regional.max_hyperparameter_rows = 50;
  // Clips of one frame, too short to have a row among those that are kept.
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const DetailModel model,
      TrainDetailModel(many.features, many.details, {0, 1, 2, 3, 120, 121}, options));
  if (!is_linear()) {
    EXPECT_EQ(model.stages().back().num_rows(), 60);
  }
  if (model.regional()) {
    EXPECT_EQ(model.regional()->parameters().inputs.rows(), 60);
  }
  const double error = Rms(PredictAll(model, many.features).details - many.details);
  EXPECT_LT(error, (is_linear() ? .7 : .1) * Spread(many.details));
}

TEST_P(DetailModelPropertiesTest, RoundingCostsNoMoreThanItsShare) {
  DetailModelOptions options = Options(motion_);
  options.rounding = 0;
  const auto predict = [&] {
    return PredictAll(TrainDetailModel(motion_.features, motion_.details, {0}, options).value(),
                      motion_.features);
  };
  const Prediction exact = predict();
  size_t last_planes = 1000;
  for (const double rounding : {1e-3, 1e-2, 1e-1}) {
    options.rounding = rounding;
    const DetailModel model =
        TrainDetailModel(motion_.features, motion_.details, {0}, options).value();
    size_t planes = 0;
    for (const auto& part : model.basis().parameters().parts) {
      planes += part.basis.components.size();
    }
    EXPECT_LE(planes, last_planes);
    last_planes = planes;
    // Each component errs by so much at most, and they err independently.
    const double share = rounding * std::sqrt(static_cast<double>(model.num_components()));
    EXPECT_LT(Rms(PredictAll(model, motion_.features).details - exact.details),
              1.5 * share * Spread(motion_.details))
        << rounding;
  }
  EXPECT_LT(last_planes, 3u * 6);
}

// Motions that say little. Whatever a learner makes of them, it must be finite, and where poses
// never differ it can only be the mean.
struct Degenerate {
  const char* name;
  void (*spoil)(SyntheticMotion&);
};

constexpr Degenerate kDegenerate[] = {
    {"still poses", [](SyntheticMotion& m) { m.features.rowwise() = m.features.row(3).eval(); }},
    {"poses of zero", [](SyntheticMotion& m) { m.features.setZero(); }},
    {"no detail", [](SyntheticMotion& m) { m.details.setZero(); }},
    {"still poses without detail",
     [](SyntheticMotion& m) {
       m.features.setOnes();
       m.details.setZero();
     }},
    {"every frame twice",
     [](SyntheticMotion& m) {
       m.features.bottomRows(20) = m.features.topRows(20).eval();
       m.details.bottomRows(20) = m.details.topRows(20).eval();
     }},
    {"one pose with two details",
     [](SyntheticMotion& m) { m.features.row(1) = m.features.row(0); }},
    {"two frames",
     [](SyntheticMotion& m) {
       m.features = m.features.topRows(2).eval();
       m.details = m.details.topRows(2).eval();
     }},
    {"two equal frames",
     [](SyntheticMotion& m) {
       m.features = m.features.topRows(1).replicate(2, 1).eval();
       m.details = m.details.topRows(1).replicate(2, 1).eval();
     }},
    {"one moving joint",
     [](SyntheticMotion& m) { m.features.rightCols(kNumFeatures - 1).setOnes(); }},
    {"tiny details", [](SyntheticMotion& m) { m.details *= 1e-12; }},
    {"huge details", [](SyntheticMotion& m) { m.details *= 1e12; }},
};

TEST_P(DetailModelPropertiesTest, MotionsThatSayLittleAreLearnedAllTheSame) {
  for (const Degenerate& kind : kDegenerate) {
    SCOPED_TRACE(kind.name);
    SyntheticMotion motion = MakeSyntheticMotion(40, kNumFeatures, kNumDetails, 4);
    kind.spoil(motion);
    const auto model = TrainDetailModel(motion.features, motion.details, {0}, Options(motion));
    ASSERT_THAT(model, IsOk());
    const double largest = 1 + motion.details.cwiseAbs().maxCoeff();
    for (const double scale : {1.0, 1.5, 1e6}) {
      const Prediction found = PredictAll(*model, scale * motion.features);
      EXPECT_TRUE(found.details.allFinite());
      EXPECT_LT(found.details.cwiseAbs().maxCoeff(), 10 * largest);
      EXPECT_GE(found.confidences.minCoeff(), 0);
      EXPECT_LE(found.confidences.maxCoeff(), 1);
    }
    if ((motion.features.rowwise() - motion.features.row(0)).isZero(0)) {
      const Eigen::RowVectorXd mean = motion.details.colwise().mean();
      const Prediction found = PredictAll(*model, motion.features);
      EXPECT_LT((found.details.rowwise() - mean).cwiseAbs().maxCoeff(), 1e-3 * largest);
    }
  }
}

TEST_P(DetailModelPropertiesTest, ComponentsThatAreGivenAreThoseOfTheDetails) {
  const DetailModelOptions options = Options(motion_);
  const bool regional = options.learner == Learner::kRegional;
  PrincipalComponents components =
      ComputePca(motion_.details, {.max_components = regional ? 256 : options.max_components,
                                   .min_energy = regional ? 1 : options.pca_energy});
  PLEAT_ASSERT_OK_AND_ASSIGN(const DetailModel model,
                             TrainDetailModel(motion_.features, components, {0}, options));
  EXPECT_EQ(PredictAll(model, queries_).details, PredictAll(Train(motion_), queries_).details);
  const auto refused = [&](const PrincipalComponents& wrong, const std::string& words) {
    EXPECT_THAT(TrainDetailModel(motion_.features, wrong, {0}, options),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  PrincipalComponents narrow = components, hole = components;
  narrow.basis.conservativeResize(Eigen::NoChange, narrow.basis.cols() - 1);
  refused(narrow, "basis of the details");
  hole.scores(3, 0) = std::nan("");
  refused(hole, "not finite");
}

// Models before version 4 of the file: the prediction is that of the direct GP and of regions with
// the same outputs, in their shares.
TEST(RegionalMixtureTest, SharesMixTheTwoPredictionsOfOldModels) {
  const SyntheticMotion motion = MakeSyntheticMotion(50, kNumFeatures, kNumDetails, 4);
  DetailModelOptions options = SmallOptions(Learner::kGp);
  options.fade_confidence = 0;
  const DetailModel gp = TrainDetailModel(motion.features, motion.details, {0}, options).value();
  const Eigen::MatrixXd scores =
      ComputePca(motion.details, {.min_energy = options.pca_energy}).scores;
  ASSERT_EQ(scores.cols(), gp.num_components());
  std::vector<GpRegion> regions(2);
  for (GpRegion& region : regions) region = {{{0, 1, 2}, {1, 3}}, .5 * scores};
  RegionalGpParameters regional = RegionalGp::Train(motion.features, regions).value().parameters();
  regional.regions[1].first_output = 0;
  regional.output_mean = Eigen::VectorXd::Zero(scores.cols());
  const RegionalGp of_regions = RegionalGp::FromParameters(regional).value();
  const auto with_share = [&](double share) {
    DetailModelParameters parameters = gp.parameters();
    parameters.learner = Learner::kRegional;
    parameters.regional = regional;
    parameters.regional_share = share;
    return DetailModel::FromParameters(std::move(parameters)).value();
  };
  DetailModel::Workspace workspace;
  RegionalGp::Workspace regional_workspace;
  Eigen::VectorXf at_0(gp.num_components()), at_1 = at_0, mixed = at_0, alone = at_0;
  Eigen::VectorXd expected(gp.num_components());
  for (const int t : {0, 7, 31}) {
    const Eigen::VectorXd row = 1.1 * motion.features.row(t).transpose();
    const double confidence = gp.PredictCoefficients(row, &workspace, alone);
    EXPECT_EQ(with_share(0).PredictCoefficients(row, &workspace, at_0), confidence);
    EXPECT_EQ(with_share(1).PredictCoefficients(row, &workspace, at_1), confidence);
    EXPECT_EQ(with_share(.25).PredictCoefficients(row, &workspace, mixed), confidence);
    of_regions.Predict(row, &regional_workspace, expected);
    EXPECT_EQ(at_0, alone);
    EXPECT_LT((at_1.cast<double>() - expected).norm(), 1e-6 * expected.norm());
    EXPECT_LT((mixed - (.75f * at_0 + .25f * at_1)).norm(), 1e-5f * mixed.norm());
  }
}

}  // namespace
}  // namespace pleat
