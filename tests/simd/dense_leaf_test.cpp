// Factorizations: the leaves of every instruction set, and the recursion over them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "pleat/simd/dense.h"
#include "simd/triangle_parts.h"
#include "support/not_a_number.h"
#include "support/random_data.h"

namespace pleat {
namespace {

using Eigen::MatrixXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Positive definite; NaN above the diagonal, which nothing may read.
MatrixXd LowerOfPositiveDefinite(int n) {
  const MatrixXd a = RandomMatrix(n, n + 2, 7);
  MatrixXd k = a * a.transpose() / n + MatrixXd::Identity(n, n) * .2;
  k.triangularView<Eigen::StrictlyUpper>().setConstant(kNan);
  return k;
}

// Cholesky's algorithm and the inverse of its factor by columns, entry by entry.
void FactorPlainly(const MatrixXd& k, MatrixXd* l, MatrixXd* w) {
  const auto n = k.rows();
  *l = *w = MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) {
      const double rest = k(i, j) - l->row(i).head(j).dot(l->row(j).head(j));
      (*l)(i, j) = i == j ? std::sqrt(rest) : rest / (*l)(j, j);
    }
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    (*w)(j, j) = 1 / (*l)(j, j);
    for (Eigen::Index i = j + 1; i < n; ++i) {
      (*w)(i, j) = -l->row(i).segment(j, i - j).dot(w->col(j).segment(j, i - j)) / (*l)(i, i);
    }
  }
}

class FactorLeafTest : public ::testing::TestWithParam<int> {};

TEST_P(FactorLeafTest, AgreesWithAPlainLoopAndTouchesNothingElse) {
  const int n = GetParam(), ld = n + 3;
  const MatrixXd given = LowerOfPositiveDefinite(n);
  MatrixXd l, w;
  FactorPlainly(given, &l, &w);
  std::vector<MatrixXd> fused;
  for (const auto& [set, ops] : DenseVariants()) {
    MatrixXd k = MatrixXd::Constant(ld, n, 77), inverse = k;
    k.topRows(n) = given;
    ASSERT_TRUE(ops->factor_leaf(k.data(), inverse.data(), n, ld)) << NameOf(set);
    EXPECT_LT((Lower(k.topRows(n)) - l).cwiseAbs().maxCoeff(), 1e-13) << NameOf(set);
    EXPECT_LT((inverse.topRows(n) - w).cwiseAbs().maxCoeff(), 1e-11) << NameOf(set);
    for (int j = 1; j < n; ++j) {
      EXPECT_TRUE(k.col(j).head(j).array().isNaN().all()) << "above the diagonal of " << j;
      EXPECT_TRUE((inverse.col(j).head(j).array() == 0).all());
    }
    EXPECT_TRUE((k.bottomRows(3).array() == 77).all()) << NameOf(set);
    EXPECT_TRUE((inverse.bottomRows(3).array() == 77).all()) << NameOf(set);
    if (set == InstructionSet::kBaseline) continue;
    if (fused.empty()) fused = {Lower(k.topRows(n)), inverse};
    EXPECT_EQ(Lower(k.topRows(n)), fused[0]) << NameOf(set);
    EXPECT_EQ(inverse, fused[1]) << NameOf(set);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, FactorLeafTest, ::testing::Range(1, int(kDenseLeaf) + 1));

TEST(FactorLeafRefusalTest, EveryPivotMustBePositiveAndFinite) {
  const int n = kDenseLeaf;
  for (const auto& [set, ops] : DenseVariants()) {
    for (int j = 0; j < n; ++j) {
      for (const double pivot :
           {0., -0., -1., -std::numeric_limits<double>::denorm_min(), kInfinity, kNan}) {
        MatrixXd k = MatrixXd::Identity(n, n), w = MatrixXd::Zero(n, n);
        k(j, j) = pivot;
        EXPECT_FALSE(ops->factor_leaf(k.data(), w.data(), n, n))
            << NameOf(set) << " pivot " << j << " is " << pivot;
      }
    }
    MatrixXd semidefinite = MatrixXd::Ones(2, 2), w = MatrixXd::Zero(2, 2);
    EXPECT_FALSE(ops->factor_leaf(semidefinite.data(), w.data(), 2, 2)) << NameOf(set);
  }
}

// Sizes around the splits of the recursion.
class FactorAndInvertTest : public ::testing::TestWithParam<int> {};

TEST_P(FactorAndInvertTest, NeverReadsAboveTheDiagonal) {
  const int n = GetParam();
  const MatrixXd given = LowerOfPositiveDefinite(n);
  MatrixXd l, plain_inverse;
  FactorPlainly(given, &l, &plain_inverse);
  for (const auto& [set, ops] : DenseVariants()) {
    MatrixXd k = given, w;
    ASSERT_TRUE(DenseSolver(*ops).FactorAndInvert(k, w)) << NameOf(set);
    EXPECT_LT((Lower(k) - l).cwiseAbs().maxCoeff(), 1e-12) << NameOf(set);
    EXPECT_LT((w - plain_inverse).cwiseAbs().maxCoeff(), 1e-10) << NameOf(set);
  }
}

// With K' = D K D for powers of two every operation scales without rounding: L' = D L, W' = W / D.
TEST_P(FactorAndInvertTest, PowersOfTwoScaleWithoutRounding) {
  const int n = GetParam();
  const MatrixXd given = LowerOfPositiveDefinite(n);
  Eigen::VectorXd scales(n);
  for (int i = 0; i < n; ++i) scales[i] = std::ldexp(1, (i * 7) % 41 - 20);
  const MatrixXd scaled = scales.asDiagonal() * given * scales.asDiagonal();
  for (const auto& [set, ops] : DenseVariants()) {
    DenseSolver solver(*ops);
    MatrixXd k = given, w, scaled_k = scaled, scaled_w;
    ASSERT_TRUE(solver.FactorAndInvert(k, w));
    ASSERT_TRUE(solver.FactorAndInvert(scaled_k, scaled_w)) << NameOf(set);
    EXPECT_EQ(Lower(scaled_k), MatrixXd(scales.asDiagonal() * Lower(k))) << NameOf(set);
    EXPECT_EQ(scaled_w, MatrixXd(w * scales.cwiseInverse().asDiagonal())) << NameOf(set);
  }
}

TEST_P(FactorAndInvertTest, WhatIsNotFiniteIsRefusedWhereverItIs) {
  const int n = GetParam();
  for (const auto& [set, ops] : DenseVariants()) {
    DenseSolver solver(*ops);
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
      for (const auto& [row, column] :
           {std::pair(0, 0), {n - 1, 0}, {n - 1, n - 1}, {n / 2, n / 3}}) {
        MatrixXd k = LowerOfPositiveDefinite(n), w;
        k(row, column) = bad;
        EXPECT_FALSE(solver.FactorAndInvert(k, w))
            << NameOf(set) << " " << bad << " at " << row << ", " << column;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, FactorAndInvertTest, ::testing::Values(1, 23, 24, 25, 49, 73, 150));

TEST(DenseSolverTest, AnEmptyMatrixIsPositiveDefinite) {
  MatrixXd k, w;
  EXPECT_TRUE(DenseSolver().FactorAndInvert(k, w));
}

// Scratch of other sizes, of a failure and of the other kind of F must not be seen.
TEST(DenseSolverTest, NothingIsLeftOfEarlierCalls) {
  for (const auto& [set, ops] : DenseVariants()) {
    DenseSolver used(*ops);
    MatrixXd used_w;
    for (const int n : {80, 30, 7, 120, 30}) {
      DenseSolver fresh(*ops);
      const MatrixXd given = LowerOfPositiveDefinite(n), f = Lower(RandomMatrix(n, n, 2));
      MatrixXd failing = given, used_k = given, fresh_k = given, fresh_w;
      failing(n - 1, n - 1) = -1;
      EXPECT_FALSE(used.FactorAndInvert(failing, used_w));
      ASSERT_TRUE(used.FactorAndInvert(used_k, used_w));
      ASSERT_TRUE(fresh.FactorAndInvert(fresh_k, fresh_w));
      EXPECT_EQ(used_w, fresh_w) << NameOf(set) << " " << n;
      MatrixXd used_gradient, fresh_gradient, solution;
      for (const bool f_lower : {false, true}) {
        const MatrixXd factor = f_lower ? f : RandomMatrix(n, 3, 4);
        EXPECT_EQ(used.Whiten(used_w, factor, f_lower), fresh.Whiten(fresh_w, factor, f_lower));
        used.Gradient(used_w, 2, solution, used_gradient);
        DenseSolver(*ops).Whiten(fresh_w, factor, f_lower);
        fresh.Gradient(fresh_w, 2, solution, fresh_gradient);
        EXPECT_EQ(Lower(used_gradient), Lower(fresh_gradient)) << NameOf(set) << " " << n;
      }
    }
  }
}

// Twice the gradient in K of D/2 log|K| + 1/2 tr(K^-1 G), by central differences.
TEST(DenseSolverTest, TheGradientIsThatOfTheObjective) {
  const int n = 9;
  const double num_outputs = 4, step = 1e-5;
  const MatrixXd lower = LowerOfPositiveDefinite(n), f = RandomMatrix(n, 3, 8);
  const MatrixXd given = lower.selfadjointView<Eigen::Lower>();
  const auto objective = [&](const MatrixXd& k) {
    MatrixXd l, w;
    FactorPlainly(k, &l, &w);
    return num_outputs * l.diagonal().array().log().sum() + .5 * (w * f).squaredNorm();
  };
  for (const auto& [set, ops] : DenseVariants()) {
    DenseSolver solver(*ops);
    MatrixXd k = given, w, solution, gradient;
    ASSERT_TRUE(solver.FactorAndInvert(k, w));
    solver.Whiten(w, f, false);
    solver.Gradient(w, num_outputs, solution, gradient);
    for (int j = 0; j < n; ++j) {
      for (int i = j; i < n; ++i) {
        MatrixXd up = given, down = given;
        up(i, j) += step, down(i, j) -= step;
        if (i != j) up(j, i) += step, down(j, i) -= step;
        const double slope = (objective(up) - objective(down)) / (2 * step);
        EXPECT_NEAR(gradient(i, j) * (i == j ? .5 : 1), slope, 1e-6 * (1 + std::abs(slope)))
            << NameOf(set) << " " << i << " " << j;
      }
    }
  }
}

}  // namespace
}  // namespace pleat
