#include "score_pca.h"

#include <gtest/gtest.h>

#include "support/random_data.h"

namespace pleat {
namespace {

// Data whose rows are maps of scores, compared with the components of the data themselves.
TEST(ScorePcaTest, ComponentsAreThoseOfTheMappedData) {
  const Eigen::MatrixXd scores =
      RandomMatrix(60, 8, 1) * Eigen::VectorXd::LinSpaced(8, 4, .5).asDiagonal();
  const Eigen::MatrixXd map = RandomMatrix(25, 8, 2);
  const Eigen::MatrixXd data = scores * map.transpose();
  const PrincipalComponents expected = ComputePca(data, {.max_components = 5});
  const ScorePca::Components found = ScorePca(scores).Compute(map, 5, 0);
  ASSERT_EQ(found.basis.cols(), 5);
  EXPECT_LT((found.basis - expected.basis).norm(), 1e-8);
  const Eigen::MatrixXd centered = data.rowwise() - data.colwise().mean();
  for (int k = 0; k < 5; ++k) {
    EXPECT_NEAR(found.rms[k], (centered * found.basis.col(k)).norm() / std::sqrt(60.), 1e-9);
  }
}

TEST(ScorePcaTest, StopsWhereTheRestIsSmallEnough) {
  const Eigen::MatrixXd scores =
      RandomMatrix(80, 6, 3) * Eigen::VectorXd::LinSpaced(6, 1, .1).asDiagonal();
  const Eigen::MatrixXd map = RandomMatrix(12, 6, 4);
  const Eigen::MatrixXd data = (scores.rowwise() - scores.colwise().mean()) * map.transpose();
  const ScorePca pca(scores);
  int last = 7;
  for (const double rest : {0.0, .1, .3, 1.0, 100.0}) {
    const Eigen::MatrixXd basis = pca.Compute(map, 100, rest).basis;
    const auto rms_left = [&](const Eigen::MatrixXd& kept) {
      return std::sqrt((data - data * kept * kept.transpose()).squaredNorm() /
                       static_cast<double>(data.size()));
    };
    EXPECT_LE(rms_left(basis), rest + 1e-9);
    if (basis.cols() > 1) {
      EXPECT_GT(rms_left(basis.leftCols(basis.cols() - 1)), rest);
    }
    EXPECT_LE(basis.cols(), last);
    last = static_cast<int>(basis.cols());
  }
  EXPECT_EQ(last, 1);
}

TEST(ScorePcaTest, DataThatDoNotVaryHaveOneComponentOfZero) {
  const ScorePca::Components none =
      ScorePca(Eigen::MatrixXd::Ones(10, 3)).Compute(RandomMatrix(7, 3, 5), 4, 0);
  EXPECT_EQ(none.basis, Eigen::MatrixXd::Zero(7, 1));
  EXPECT_EQ(none.rms, Eigen::VectorXd::Zero(1));
}

TEST(FirstComponentsTest, AreAsManyAsTheEnergyNeeds) {
  const Eigen::MatrixXd data =
      RandomMatrix(40, 9, 6) * Eigen::VectorXd::LinSpaced(9, 3, .1).asDiagonal();
  const PrincipalComponents all = ComputePca(data);
  for (const double energy : {.3, .7, .95, .9999}) {
    const PrincipalComponents expected = ComputePca(data, {.min_energy = energy});
    const PrincipalComponents found = FirstComponents(all, 100, energy);
    EXPECT_EQ(found.basis, expected.basis) << energy;
    EXPECT_EQ(found.scores, expected.scores);
    EXPECT_NEAR(found.kept_energy, expected.kept_energy, 1e-12);
  }
  EXPECT_EQ(FirstComponents(all, 2, 1).basis.cols(), 2);
}

}  // namespace
}  // namespace pleat
