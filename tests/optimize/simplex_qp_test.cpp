#include "pleat/optimize/simplex_qp.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"

namespace pleat {
namespace {

SimplexQpMatrix RandomHessian(int n, Random* random) {
  Eigen::MatrixXd factor(n + 2, n);
  for (double& value : factor.reshaped()) value = random->Normal();
  return factor.transpose() * factor;
}

SimplexQpVector RandomVector(int n, double scale, Random* random) {
  SimplexQpVector vector(n);
  for (double& value : vector) value = scale * random->Normal();
  return vector;
}

double ObjectiveAt(const SimplexQpMatrix& hessian, const SimplexQpVector& linear,
                   const SimplexQpVector& x) {
  return 0.5 * x.dot(hessian * x) - linear.dot(x);
}

void ExpectFeasible(const SimplexQpVector& x) {
  EXPECT_GE(x.minCoeff(), 0);
  EXPECT_NEAR(x.sum(), 1, 1e-12);
}

// Karush-Kuhn-Tucker: the gradient is one value where x > 0 and not less elsewhere.
void ExpectOptimal(const SimplexQpMatrix& hessian, const SimplexQpVector& linear,
                   const SimplexQpVector& x) {
  const SimplexQpVector gradient = hessian * x - linear;
  const double multiplier = gradient.dot(x);
  for (int i = 0; i < x.size(); ++i) {
    if (x[i] > 0) {
      EXPECT_NEAR(gradient[i], multiplier, 1e-9) << i;
    } else {
      EXPECT_GT(gradient[i], multiplier - 1e-9) << i;
    }
  }
}

TEST(SimplexQp, ReachesTheOptimumFromEveryStart) {
  Random random(3);
  for (int n = 1; n <= kMaxSimplexQpSize; ++n) {
    for (int trial = 0; trial < 40; ++trial) {
      const SimplexQpMatrix hessian = RandomHessian(n, &random);
      const SimplexQpVector linear = RandomVector(n, 5, &random);
      SimplexQpVector corner = SimplexQpVector::Unit(n, trial % n);
      SimplexQpVector middle = SimplexQpVector::Constant(n, 1.0 / n);
      SolveSimplexQp(hessian, linear, &corner);
      SolveSimplexQp(hessian, linear, &middle);
      ExpectFeasible(corner);
      ExpectOptimal(hessian, linear, corner);
      EXPECT_NEAR((corner - middle).norm(), 0, 1e-8);
    }
  }
}

TEST(SimplexQp, FindsKnownWeightsAgain) {
  Random random(4);
  const SimplexQpMatrix hessian = RandomHessian(6, &random);
  SimplexQpVector truth = SimplexQpVector::Zero(6);
  truth << 0.5, 0, 0.2, 0, 0.3, 0;
  SimplexQpVector x = SimplexQpVector::Constant(6, 1.0 / 6);
  SolveSimplexQp(hessian, hessian * truth, &x);
  EXPECT_NEAR((x - truth).norm(), 0, 1e-10);
}

TEST(SimplexQp, NearlySingularMatricesStayFeasible) {
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const SimplexQpVector direction = RandomVector(9, 1, &random);
    SimplexQpMatrix hessian = direction * direction.transpose();
    hessian.diagonal().array() += 1e-9;
    SimplexQpVector x = SimplexQpVector::Unit(9, 0);
    const SimplexQpVector linear = RandomVector(9, 1, &random);
    const double before = ObjectiveAt(hessian, linear, x);
    SolveSimplexQp(hessian, linear, &x);
    EXPECT_GE(x.minCoeff(), 0);
    EXPECT_NEAR(x.sum(), 1, 1e-12);
    EXPECT_LE(ObjectiveAt(hessian, linear, x), before + 1e-6);
  }
}

// Which unknown comes first, and in which unit the objective is, must not matter.
TEST(SimplexQp, OrderAndUnitDoNotMatter) {
  Random random(8);
  for (int trial = 0; trial < 50; ++trial) {
    const SimplexQpMatrix hessian = RandomHessian(7, &random);
    const SimplexQpVector linear = RandomVector(7, 2, &random);
    SimplexQpVector x = SimplexQpVector::Constant(7, 1.0 / 7), reversed = x, scaled = x;
    SolveSimplexQp(hessian, linear, &x);
    SolveSimplexQp(hessian.reverse(), linear.reverse(), &reversed);
    SolveSimplexQp(1e-9 * hessian, 1e-9 * linear, &scaled);
    EXPECT_LT((reversed.reverse() - x).norm(), 1e-9);
    EXPECT_LT((scaled - x).norm(), 1e-9);
    // A constant on all of `linear` is the same everywhere on the simplex.
    SimplexQpVector shifted = SimplexQpVector::Unit(7, 2);
    SolveSimplexQp(hessian, linear + SimplexQpVector::Constant(7, 5), &shifted);
    EXPECT_LT((shifted - x).norm(), 1e-9);
  }
}

TEST(SimplexQp, SupportOfOneIsACorner) {
  Random random(9);
  for (int trial = 0; trial < 20; ++trial) {
    const SimplexQpMatrix hessian = RandomHessian(5, &random);
    const SimplexQpVector linear = RandomVector(5, .3, &random);
    SimplexQpVector full = SimplexQpVector::Constant(5, .2), corner = full;
    SolveSimplexQp(hessian, linear, &full);
    SolveSparseSimplexQp(hessian, linear, 1, &corner);
    Eigen::Index largest = 0;
    full.maxCoeff(&largest);
    EXPECT_EQ(corner, SimplexQpVector(SimplexQpVector::Unit(5, largest)));
  }
}

TEST(SimplexQp, SparseSolutionIsOptimalAmongItsSupport) {
  Random random(6);
  for (int trial = 0; trial < 100; ++trial) {
    const SimplexQpMatrix hessian = RandomHessian(10, &random);
    const SimplexQpVector linear = RandomVector(10, 0.3, &random);
    SimplexQpVector full = SimplexQpVector::Constant(10, 0.1), sparse = full;
    SolveSimplexQp(hessian, linear, &full);
    SolveSparseSimplexQp(hessian, linear, 4, &sparse);
    ExpectFeasible(sparse);
    EXPECT_LE((sparse.array() > 0).count(), 4);
    EXPECT_GE(ObjectiveAt(hessian, linear, sparse), ObjectiveAt(hessian, linear, full) - 1e-12);
    if ((full.array() > 0).count() <= 4) {
      EXPECT_EQ(sparse, full);
    }
  }
}

}  // namespace
}  // namespace pleat
