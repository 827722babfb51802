#include "pleat/math/pca.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"

namespace pleat {
namespace {

// Rank-3 data with a mean, N x D.
Eigen::MatrixXd LowRankData(int rows, int columns) {
  Random random(9);
  Eigen::MatrixXd left(rows, 3), right(3, columns);
  for (double& entry : left.reshaped()) entry = random.Normal();
  for (double& entry : right.reshaped()) entry = random.Normal();
  right.row(0) *= 10;
  right.row(2) *= 0.1;
  return (left * right).array() + 5;
}

class PcaTest : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(PcaTest, ReconstructsWithOrthonormalBasisOfTheTrueRank) {
  const Eigen::MatrixXd data = LowRankData(GetParam().first, GetParam().second);
  const PrincipalComponents pca = ComputePca(data);
  ASSERT_EQ(pca.basis.cols(), 3);
  EXPECT_NEAR(pca.kept_energy, 1, 1e-9);
  EXPECT_LT((pca.basis.transpose() * pca.basis - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  const Eigen::MatrixXd rebuilt =
      (pca.scores * pca.basis.transpose()).rowwise() + pca.mean.transpose();
  EXPECT_LT((rebuilt - data).norm(), 1e-9 * data.norm());
  for (int c = 0; c < 3; ++c) {
    Eigen::Index row;
    pca.basis.col(c).cwiseAbs().maxCoeff(&row);
    EXPECT_GT(pca.basis(row, c), 0);
    EXPECT_GE(pca.scores.col(std::max(c - 1, 0)).norm(), pca.scores.col(c).norm());
  }
}

INSTANTIATE_TEST_SUITE_P(WideAndTall, PcaTest,
                         testing::Values(std::pair(12, 90), std::pair(90, 12), std::pair(20, 20)));

TEST(PcaTest, StopsAtEnergyAndAtTheCount) {
  const Eigen::MatrixXd data = LowRankData(30, 60);
  const PrincipalComponents one = ComputePca(data, {.max_components = 1});
  EXPECT_EQ(one.basis.cols(), 1);
  EXPECT_LT(one.kept_energy, 1);
  const PrincipalComponents most = ComputePca(data, {.min_energy = one.kept_energy - 1e-6});
  EXPECT_EQ(most.basis.cols(), 1);
  EXPECT_EQ(ComputePca(data, {.min_energy = one.kept_energy + 1e-6}).basis.cols(), 2);
}

TEST(PcaTest, ConstantDataHasNoComponents) {
  const PrincipalComponents pca = ComputePca(Eigen::MatrixXd::Constant(5, 8, 2.5));
  EXPECT_EQ(pca.basis.cols(), 0);
  EXPECT_EQ(pca.kept_energy, 1);
  EXPECT_EQ(pca.mean, Eigen::VectorXd::Constant(8, 2.5));
}

}  // namespace
}  // namespace pleat
