#include "pleat/gp/marginal_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/gp_predictions.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(MarginalLikelihoodTest, GradientIsTheSlopeInEveryUnknown) {
  const Eigen::MatrixXd inputs = RandomMatrix(20, 6, 1), outputs = RandomMatrix(20, 3, 2);
  GpRegressionOptions options;
  options.prior_precision = .02;
  options.relevance_precision = .05;
  for (const std::vector<std::vector<int>>& groups :
       {std::vector<std::vector<int>>{}, {{0, 2}, {5}, {1, 3}}}) {
    options.input_groups = groups;
    PLEAT_ASSERT_OK_AND_ASSIGN(GramData data, MakeGramData(outputs));
    MarginalLikelihood objective(inputs, std::move(data), options, .3, {});
    ASSERT_EQ(objective.num_unknowns(), 5 + static_cast<int>(groups.size()));
    for (int seed = 0; seed < 4; ++seed) {
      const Eigen::VectorXd x = RandomMatrix(objective.num_unknowns(), 1, 10 + seed).col(0);
      const GradientCheck check = CheckGradient(objective, x);
      EXPECT_LT(check.max_relative_error, 1e-5)
          << "unknown " << check.worst_unknown << ": " << check.analytic << " or " << check.numeric;
    }
  }
}

TEST(MarginalLikelihoodTest, FactorsAreRootsOfWhatMultipliesSquaredDistances) {
  const std::vector<std::vector<int>> groups = {{3, 0}, {1}};
  const Eigen::VectorXd factors = RelevanceFactors(groups, Eigen::Vector2d(std::log(9), -99), 5);
  EXPECT_NEAR(factors[0], 3, 1e-12);
  EXPECT_EQ(factors[3], factors[0]);
  EXPECT_EQ(factors[1], std::exp(-.5 * kMaxKernelLog));  // clamped
  EXPECT_EQ(factors[2], 1);                              // in no group
  EXPECT_EQ(factors[4], 1);
}

// All columns in one group: a factor on their squared distances is a factor of g, where the kernel
// has no linear term.
TEST(MarginalLikelihoodTest, OneGroupOfEverythingIsAnotherWidth) {
  GpRegressionOptions options;
  options.kernel.linear = false;
  options.prior_precision = options.relevance_precision = 0;
  options.input_groups = {{0, 1, 2}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData data, MakeGramData(RandomMatrix(15, 2, 2)));
  MarginalLikelihood objective(RandomMatrix(15, 3, 1), data, options, 0, {});
  Eigen::VectorXd x(5), gradient;
  x << -.3, .2, -1, -2, .8;
  const double value = objective.Evaluate(x, &gradient);
  EXPECT_NEAR(gradient[4], gradient[0], 1e-9 * std::abs(gradient[0]));
  x[0] += x[4];
  x[4] = 0;
  EXPECT_NEAR(objective.Evaluate(x, nullptr), value, 1e-9 * std::abs(value));
}

// Outputs follow the first two columns; the other four say nothing.
TEST(MarginalLikelihoodTest, WhatSaysNothingIsFoundOut) {
  const Eigen::MatrixXd x = RandomMatrix(80, 6, 1), x_new = RandomMatrix(60, 6, 2);
  const auto truth = [](const Eigen::MatrixXd& at) {
    return Eigen::MatrixXd((2 * at.col(0).array()).sin() * at.col(1).array().cos());
  };
  GpRegressionOptions options;
  options.input_groups = {{0, 1}, {2, 3}, {4, 5}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression blind, GpRegression::Train(x, truth(x)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression seeing, GpRegression::Train(x, truth(x), options));
  const Eigen::VectorXd& scales = seeing.parameters().input_scales;
  EXPECT_EQ(scales[0], scales[1]);
  EXPECT_GT(scales[2], 3 * scales[0]);
  EXPECT_GT(scales[4], 3 * scales[0]);
  const Eigen::MatrixXd by_blind = PredictRows(blind, x_new).means;
  const Eigen::MatrixXd by_seeing = PredictRows(seeing, x_new).means;
  EXPECT_LT((by_seeing - truth(x_new)).norm(), .5 * (by_blind - truth(x_new)).norm());
}

TEST(MarginalLikelihoodTest, GroupsThatOverlapOrDoNotExistAreTold) {
  const Eigen::MatrixXd x = RandomMatrix(10, 3, 1);
  for (const std::vector<std::vector<int>>& groups :
       {std::vector<std::vector<int>>{{0, 1}, {1}}, {{3}}, {{-1}}}) {
    GpRegressionOptions options;
    options.input_groups = groups;
    EXPECT_THAT(GpRegression::Train(x, x, options),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("groups of inputs")));
  }
}

}  // namespace
}  // namespace pleat
