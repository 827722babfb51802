#include "pleat/simd/dense.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "simd/triangle_parts.h"
#include "support/random_data.h"

namespace pleat {
namespace {

Eigen::MatrixXd RandomPositiveDefinite(int n) {
  const Eigen::MatrixXd a = RandomMatrix(n, n + 3, 5);
  return a * a.transpose() / n + Eigen::MatrixXd::Identity(n, n) * .1;
}

// Sizes around every tile and block edge.
class DenseTest : public ::testing::TestWithParam<int> {};

TEST_P(DenseTest, FactorsAndInverts) {
  const int n = GetParam();
  const Eigen::MatrixXd k = RandomPositiveDefinite(n);
  for (const auto& [set, ops] : DenseVariants()) {
    DenseSolver solver(*ops);
    Eigen::MatrixXd factor = k, inverse_factor, inverse, none;
    ASSERT_TRUE(solver.FactorAndInvert(factor, inverse_factor)) << NameOf(set);
    EXPECT_LT((Lower(factor) * Lower(factor).transpose() - k).norm(), 1e-12 * k.norm());
    EXPECT_LT((inverse_factor * Lower(factor) - Eigen::MatrixXd::Identity(n, n)).norm(), 1e-11);
    EXPECT_EQ((inverse_factor - Lower(inverse_factor)).norm(), 0);
    solver.Whiten(inverse_factor, Eigen::MatrixXd(n, 0), false);
    solver.Gradient(inverse_factor, 1, none, inverse);
    const Eigen::MatrixXd full = inverse.selfadjointView<Eigen::Lower>();
    EXPECT_LT((full * k - Eigen::MatrixXd::Identity(n, n)).norm(), 1e-10) << NameOf(set);
  }
}

TEST_P(DenseTest, MultipliesByTriangles) {
  const int n = GetParam();
  const Eigen::MatrixXd w = Lower(RandomMatrix(n, n, 1));
  const Eigen::MatrixXd wide = RandomMatrix(n, 7, 2);
  for (const auto& [set, ops] : DenseVariants()) {
    DenseSolver solver(*ops);
    Eigen::MatrixXd h;
    solver.MultiplyByFactor(w, false, wide, h);
    EXPECT_LT((h - w * wide).norm(), 1e-12 * n * n);
    solver.MultiplyByFactor(w, true, wide, h);
    EXPECT_LT((h - w.transpose() * wide).norm(), 1e-12 * n * n);
    Eigen::MatrixXd s;
    solver.OuterProduct(wide, s);
    EXPECT_LT((Lower(s) - Lower(wide * wide.transpose())).norm(), 1e-12 * n * n) << NameOf(set);
  }
}

// D K^-1 - K^-1 G K^-1 from a lower triangular factor of G and from a narrow one.
TEST_P(DenseTest, GradientsAgreeWithEigen) {
  const int n = GetParam();
  const Eigen::MatrixXd k = RandomPositiveDefinite(n);
  const Eigen::MatrixXd inverse = k.inverse();
  const Eigen::MatrixXd square = Lower(RandomMatrix(n, n, 3)), narrow = RandomMatrix(n, 5, 8);
  for (const auto& [set, ops] : DenseVariants()) {
    DenseSolver solver(*ops);
    Eigen::MatrixXd factor = k, w, solution, gradient;
    ASSERT_TRUE(solver.FactorAndInvert(factor, w));
    for (const Eigen::MatrixXd& f : {square, narrow}) {
      const Eigen::MatrixXd truth = 9 * inverse - inverse * f * f.transpose() * inverse;
      const double trace = (inverse * f).cwiseProduct(f).sum();
      EXPECT_NEAR(solver.Whiten(w, f, f.cols() == n), trace, 1e-10 * (1 + trace)) << NameOf(set);
      solver.Gradient(w, 9, solution, gradient);
      EXPECT_LT((Lower(gradient) - Lower(truth)).norm(), 1e-10 * (1 + truth.norm())) << NameOf(set);
    }
    EXPECT_LT((solution - inverse * narrow).norm(), 1e-10 * (1 + solution.norm())) << NameOf(set);
  }
}

TEST_P(DenseTest, SweepsAgreeWithEigen) {
  const int n = GetParam();
  const Eigen::MatrixXd x = RandomMatrix(n, 3, 4);
  Eigen::MatrixXd truth(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) truth(i, j) = (x.row(i) - x.row(j)).squaredNorm();
  }
  const Eigen::MatrixXd rbf = 1.5 * (-.35 * truth.array()).exp();
  const Eigen::MatrixXd t = x * x.transpose(), q0 = RandomMatrix(n, n, 6);
  for (const auto& [set, ops] : DenseVariants()) {
    Eigen::MatrixXd r(n, n), k(n, n), q = q0, p(n, n);
    ops->squared_distances(x.data(), n, 3, r.data());
    EXPECT_LT((Lower(r) - Lower(truth)).norm(), 1e-12 * n);
    ops->kernel(r.data(), t.data(), n, .7, 1.5, .2, .4, k.data());
    EXPECT_LT((Lower(k) - Lower((rbf.array() + .2).matrix() + .4 * t)).norm(), 1e-13 * n);
    const GramSums sums =
        ops->gram_gradient(q.data(), r.data(), t.data(), n, .7, 1.5, .5, p.data());
    const Eigen::MatrixXd lower = Lower(.5 * q0);
    const Eigen::MatrixXd a = lower.selfadjointView<Eigen::Lower>();
    const double scale = 1e-12 * n * n;
    EXPECT_NEAR(sums.trace, a.trace(), scale);
    EXPECT_NEAR(sums.total, a.sum(), scale);
    EXPECT_NEAR(sums.amplitude, a.cwiseProduct(rbf).sum(), scale);
    EXPECT_NEAR(sums.distance, a.cwiseProduct(rbf).cwiseProduct(truth).sum(), scale);
    EXPECT_NEAR(sums.linear, a.cwiseProduct(t).sum(), 10 * scale);
    EXPECT_LT((Lower(q) - lower).norm(), scale);
    EXPECT_LT((Lower(p) - Lower(a.cwiseProduct(rbf))).norm(), scale) << NameOf(set);
    Eigen::MatrixXd in_place = q0;
    const GramSums same =
        ops->gram_gradient(in_place.data(), r.data(), t.data(), n, .7, 1.5, .5, in_place.data());
    EXPECT_EQ(Lower(in_place), Lower(p));
    EXPECT_EQ(same.distance, sums.distance);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, DenseTest, ::testing::Values(1, 2, 7, 24, 25, 48, 97, 200, 301));

TEST(DenseOpsTest, ExponentialIsAccurate) {
  for (const auto& [set, ops] : DenseVariants()) {
    std::vector<double> values;
    for (double x = -50; x <= 0; x += .0137) values.push_back(x);
    values.push_back(0);
    values.push_back(-700);
    std::vector<double> result = values;
    ops->exp_in_place(result.data(), static_cast<ptrdiff_t>(result.size()));
    for (size_t i = 0; i < values.size(); ++i) {
      EXPECT_NEAR(result[i] / std::exp(values[i]), 1, 1e-15) << values[i] << " " << NameOf(set);
    }
    double tiny[3] = {-1e4, -1e300, -std::numeric_limits<double>::infinity()};
    ops->exp_in_place(tiny, 3);
    for (const double value : tiny) EXPECT_LT(value, 1e-300);
  }
}

// The promise of dense.h: register width does not change a bit.
TEST(DenseOpsTest, KernelsWithFmaGiveTheSameBits) {
  std::vector<const DenseOps*> all;
  for (const auto& [set, ops] : DenseVariants()) {
    if (set != InstructionSet::kBaseline) all.push_back(ops);
  }
  if (all.size() < 2) GTEST_SKIP() << "this processor has only one set of kernels with FMA";
  const int n = 299;  // longer than a chunk of a sum, and not a multiple of anything
  const Eigen::MatrixXd x = RandomMatrix(n, 5, 4), f = Lower(RandomMatrix(n, n, 3));
  std::vector<Eigen::MatrixXd> first;
  for (const DenseOps* ops : all) {
    DenseSolver solver(*ops);
    Eigen::MatrixXd r(n, n), k(n, n), w, solution, gradient, p(n, n), y;
    ops->squared_distances(x.data(), n, 5, r.data());
    ops->kernel(r.data(), nullptr, n, .7, 1.5, .2, 0, k.data());
    k.diagonal().array() += 1e-2;
    ASSERT_TRUE(solver.FactorAndInvert(k, w));
    std::vector<Eigen::MatrixXd> results = {Lower(r), Lower(k), w};
    for (const Eigen::MatrixXd& factor : {f, x}) {
      const double trace = solver.Whiten(w, factor, factor.cols() == n);
      solver.Gradient(w, 7, solution, gradient);
      const GramSums sums =
          ops->gram_gradient(gradient.data(), r.data(), nullptr, n, .7, 1.5, .5, p.data());
      solver.SymmetricMultiply(p, x, y);
      for (const double value : {trace, sums.trace, sums.total, sums.amplitude, sums.distance}) {
        results.push_back(Eigen::MatrixXd::Constant(1, 1, value));
      }
      results.insert(results.end(), {Lower(gradient), Lower(p), y});
    }
    if (first.empty()) first = results;
    for (size_t m = 0; m < results.size(); ++m) {
      EXPECT_EQ((first[m] - results[m]).cwiseAbs().maxCoeff(), 0) << "matrix " << m;
    }
  }
}

TEST(DenseOpsTest, RefusesAnIndefiniteMatrix) {
  DenseSolver solver;
  Eigen::MatrixXd k = RandomPositiveDefinite(60), w;
  k(50, 50) = -1;
  EXPECT_FALSE(solver.FactorAndInvert(k, w));
  k = RandomPositiveDefinite(60);
  k(3, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(solver.FactorAndInvert(k, w));
}

}  // namespace
}  // namespace pleat
