#include "baselines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/math/pca.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

constexpr int kNumFrames = 60, kNumFeatures = 4, kNumValues = 9;

class BaselinesTest : public testing::Test {
 protected:
  BaselinesTest() {
    data_.features = RandomMatrix(kNumFrames, kNumFeatures, 1);
    // Details that are an affine function of the features: ridge can learn them.
    details_ = data_.features * RandomMatrix(kNumFeatures, kNumValues, 2);
    details_.rowwise() += RandomMatrix(1, kNumValues, 3).row(0);
    data_.details.mean = details_.colwise().mean().transpose();
    data_.details.basis = Eigen::MatrixXd::Identity(kNumValues, kNumValues);
    data_.details.scores = details_.rowwise() - data_.details.mean.transpose();
    baselines_ = TrainBaselines(data_).value();
  }
  Eigen::VectorXd Predict(const std::string& name, const Eigen::VectorXd& features) const {
    return baselines_.at(name)(features);
  }

  LearningData data_;
  Eigen::MatrixXd details_;  // T x 3C
  std::map<std::string, DetailPredictor> baselines_;
};

TEST_F(BaselinesTest, AreTheFourOfTheDocumentation) {
  std::vector<std::string> names;
  for (const auto& [name, predictor] : baselines_) names.push_back(name);
  EXPECT_THAT(names, testing::ElementsAre("mean", "nearest", "ridge", "zero"));
}

TEST_F(BaselinesTest, ZeroAndMeanDoNotLookAtTheFeatures) {
  for (int t = 0; t < 5; ++t) {
    const Eigen::VectorXd features = RandomMatrix(kNumFeatures, 1, 10 + t).col(0);
    EXPECT_EQ(Predict("zero", features), Eigen::VectorXd::Zero(kNumValues));
    EXPECT_LT((Predict("mean", features) - details_.colwise().mean().transpose()).norm(), 1e-12);
  }
}

TEST_F(BaselinesTest, NearestGivesATrainingFrame) {
  for (int t = 0; t < kNumFrames; ++t) {
    const Eigen::VectorXd near = data_.features.row(t).transpose().array() + 1e-6;
    EXPECT_LT((Predict("nearest", near) - details_.row(t).transpose()).norm(), 1e-9) << t;
  }
}

TEST_F(BaselinesTest, RidgeLearnsWhatIsLinear) {
  const Eigen::VectorXd features = data_.features.colwise().mean().transpose();
  EXPECT_LT((Predict("ridge", features) - details_.colwise().mean().transpose()).norm(), 1e-6);
  double square = 0;
  for (int t = 0; t < kNumFrames; ++t) {
    square += (Predict("ridge", data_.features.row(t).transpose()) - details_.row(t).transpose())
                  .squaredNorm();
  }
  EXPECT_LT(square, 1e-2 * data_.details.scores.squaredNorm());
}

}  // namespace
}  // namespace pleat
