#include "pleat/gp/inducing.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "support/random_data.h"

namespace pleat {
namespace {

const std::vector<AdditiveTerm> kTerms = {{.inverse_width = .3, .amplitude = 1.5, .linear = .2},
                                          {.inverse_width = 2, .amplitude = .4, .linear = 0}};
constexpr double kBias = .1, kNoise = .05;

std::vector<Eigen::MatrixXd> Sets(int num_rows, uint64_t seed) {
  return {RandomMatrix(num_rows, 3, seed), RandomMatrix(num_rows, 2, seed + 1)};
}

TEST(AdditiveCovarianceTest, IsTheFormula) {
  const std::vector<Eigen::MatrixXd> a = Sets(9, 1), b = Sets(4, 5);
  const Eigen::MatrixXd covariance = AdditiveCovariance(a, b, kTerms, kBias);
  ASSERT_EQ(covariance.rows(), 9);
  ASSERT_EQ(covariance.cols(), 4);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 4; ++j) {
      double expected = kBias;
      for (int e = 0; e < 2; ++e) {
        expected += kTerms[e].amplitude * std::exp(-.5 * kTerms[e].inverse_width *
                                                   (a[e].row(i) - b[e].row(j)).squaredNorm()) +
                    kTerms[e].linear * a[e].row(i).dot(b[e].row(j));
      }
      EXPECT_NEAR(covariance(i, j), expected, 1e-12);
    }
  }
}

// A problem whose exact posterior is known from plain algebra.
struct Exact {
  std::vector<Eigen::MatrixXd> sets = Sets(700, 7), queries = Sets(5, 9);  // more than one block
  Eigen::MatrixXd outputs =
      (sets[0].col(0).array().sin().matrix() + sets[1].col(1)) * Eigen::RowVector2d(1, -2);
  Eigen::MatrixXd covariance = AdditiveCovariance(sets, sets, kTerms, kBias);
  Eigen::MatrixXd cross = AdditiveCovariance(queries, sets, kTerms, kBias);
  Eigen::LLT<Eigen::MatrixXd> factor{
      Eigen::MatrixXd(covariance + kNoise * Eigen::MatrixXd::Identity(700, 700))};
  Eigen::MatrixXd mean = cross * factor.solve(outputs);  // 5 x 2
};

InducedWeights Induced(const Exact& exact, const std::vector<Eigen::MatrixXd>& inducing) {
  InducedWeights weights;
  const auto cross = [&](Eigen::Index begin, Eigen::Index count) {
    return AdditiveCovariance(
        {exact.sets[0].middleRows(begin, count), exact.sets[1].middleRows(begin, count)}, inducing,
        kTerms, kBias);
  };
  EXPECT_TRUE(SolveInduced(
      AdditiveCovariance(inducing, inducing, kTerms, kBias), kNoise, exact.outputs, cross,
      [] { return false; }, true, &weights));
  return weights;
}

TEST(InducingTest, AllRowsInducingIsTheExactPosterior) {
  const Exact exact;
  const InducedWeights weights = Induced(exact, exact.sets);
  EXPECT_LT((exact.cross * weights.alpha - exact.mean).cwiseAbs().maxCoeff(), 1e-4);
  for (int i = 0; i < 5; ++i) {
    const Eigen::VectorXd k = exact.cross.row(i).transpose();
    const double known = k.dot(exact.factor.solve(k));
    EXPECT_NEAR((weights.whitener * k.cast<float>()).squaredNorm(), known, 2e-3 * known);
  }
}

TEST(InducingTest, FewInducingRowsLearnFromAllRows) {
  const Exact exact;
  const std::vector<Eigen::MatrixXd> few = {exact.sets[0].topRows(120), exact.sets[1].topRows(120)};
  const Eigen::MatrixXd cross = AdditiveCovariance(exact.queries, few, kTerms, kBias);
  const double induced =
      (cross * Induced(exact, few).alpha - exact.mean).norm() / exact.mean.norm();
  // The same rows, and nothing of the others.
  Eigen::MatrixXd alone = AdditiveCovariance(few, few, kTerms, kBias);
  alone.diagonal().array() += kNoise;
  const Eigen::MatrixXd mean = cross * alone.llt().solve(exact.outputs.topRows(120));
  const double subset = (mean - exact.mean).norm() / exact.mean.norm();
  EXPECT_LT(induced, .5 * subset);
  EXPECT_LT(induced, .1);
}

TEST(InducingTest, WhitenerIsLowerTriangular) {
  const Exact exact;
  const InducedWeights weights =
      Induced(exact, {exact.sets[0].topRows(50), exact.sets[1].topRows(50)});
  EXPECT_EQ(weights.whitener.triangularView<Eigen::StrictlyUpper>().toDenseMatrix().squaredNorm(),
            0);
}

TEST(InducingTest, WhatCannotBeFactoredIsNoSolution) {
  const Eigen::MatrixXd outputs = RandomMatrix(6, 1, 1);
  const auto solves = [&](const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& cross) {
    InducedWeights weights;
    return SolveInduced(
        covariance, kNoise, outputs,
        [&](Eigen::Index begin, Eigen::Index count) {
          return Eigen::MatrixXd(cross.middleRows(begin, count));
        },
        [] { return false; }, true, &weights);
  };
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(3, 3), cross = RandomMatrix(6, 3, 2);
  EXPECT_TRUE(solves(identity, cross));
  EXPECT_FALSE(solves(-identity, cross));
  EXPECT_FALSE(solves(std::nan("") * identity, cross));
  EXPECT_FALSE(solves(identity, std::nan("") * cross));
}

TEST(InducingTest, StopsWhenCancelled) {
  const Exact exact;
  InducedWeights weights;
  EXPECT_FALSE(SolveInduced(
      exact.covariance, kNoise, exact.outputs,
      [&](Eigen::Index begin, Eigen::Index count) {
        return exact.covariance.middleRows(begin, count).eval();
      },
      [] { return true; }, false, &weights));
}

}  // namespace
}  // namespace pleat
