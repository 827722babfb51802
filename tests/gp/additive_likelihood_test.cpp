#include "pleat/gp/additive_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pleat/gp/kernel.h"

namespace pleat {
namespace {

Eigen::MatrixXd Waves(int rows, int columns, double phase) {
  Eigen::MatrixXd waves(rows, columns);
  for (int t = 0; t < rows; ++t) {
    for (int c = 0; c < columns; ++c) waves(t, c) = std::sin(.4 * (c + 1) * t + phase * c);
  }
  return waves / std::sqrt(.5 * columns);
}

AdditiveLikelihood MakeLikelihood(double prior_precision) {
  const Eigen::MatrixXd outputs = Waves(14, 5, .7).rowwise() - Waves(14, 5, .7).colwise().mean();
  return AdditiveLikelihood({Waves(14, 4, .2), Waves(14, 2, .9)}, *MakeGramData(outputs),
                            prior_precision, {});
}

TEST(AdditiveLikelihoodTest, GradientsAgreeWithDifferences) {
  for (const double precision : {0.0, .01}) {
    AdditiveLikelihood likelihood = MakeLikelihood(precision);
    Eigen::VectorXd x = likelihood.Start();
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += .3 * std::sin(1.0 + double(i));
    const GradientCheck check = CheckGradient(likelihood, x);
    EXPECT_LT(check.max_relative_error, 1e-5)
        << "unknown " << check.worst_unknown << ": " << check.analytic << " or " << check.numeric;
  }
}

TEST(AdditiveLikelihoodTest, OneScaleIsTheGramTerm) {
  const Eigen::MatrixXd inputs = Waves(14, 4, .2), outputs = Waves(14, 5, .7);
  AdditiveLikelihood likelihood({inputs}, *MakeGramData(outputs), 0, {});
  GramTerm term(14, {.bias = true, .linear = true});
  term.SetInputs(inputs);
  const KernelLogs logs{
      .inverse_width = .2, .amplitude = -.3, .bias = -2, .noise = -3, .linear = -1};
  Eigen::VectorXd x(5);
  x << logs.inverse_width, logs.amplitude, logs.linear, logs.noise, logs.bias;
  EXPECT_NEAR(likelihood.Evaluate(x, nullptr),
              term.Evaluate(logs, *MakeGramData(outputs), 1, false), 1e-9);
}

// The order of unknowns for sets {second, first}, from that for {first, second}.
Eigen::VectorXd Exchanged(const Eigen::VectorXd& x) {
  Eigen::VectorXd y = x;
  for (const int i : {0, 2, 4}) std::swap(y[i], y[i + 1]);
  return y;
}

TEST(AdditiveLikelihoodTest, OrderOfTheSetsDoesNotMatter) {
  const GramData data = *MakeGramData(Waves(14, 5, .7));
  AdditiveLikelihood one({Waves(14, 4, .2), Waves(14, 2, .9)}, data, .01, {});
  AdditiveLikelihood other({Waves(14, 2, .9), Waves(14, 4, .2)}, data, .01, {});
  Eigen::VectorXd x = one.Start(), gradient, exchanged;
  EXPECT_LT((other.Start() - Exchanged(x)).norm(), 1e-12);
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += .3 * std::sin(1.0 + double(i));
  const double value = one.Evaluate(x, &gradient);
  EXPECT_NEAR(other.Evaluate(Exchanged(x), &exchanged), value, 1e-9 * std::abs(value));
  EXPECT_LT((exchanged - Exchanged(gradient)).norm(), 1e-8 * gradient.norm());
}

TEST(AdditiveLikelihoodTest, StartsWithAKernelOfOneAndSolvesWithItsLast) {
  AdditiveLikelihood likelihood = MakeLikelihood(0);
  const Eigen::VectorXd start = likelihood.Start(), values = start.array().exp();
  EXPECT_NEAR(values.segment(2, 4).sum(), 1, 1e-12);  // amplitudes and slopes
  EXPECT_NEAR(AdditiveLikelihood::Noise(values), values[6] + 1e-6 * values.segment(2, 2).sum(),
              1e-15);
  ASSERT_TRUE(std::isfinite(likelihood.Evaluate(start, nullptr)));
  Eigen::MatrixXd k = Eigen::MatrixXd::Constant(14, 14, values[7]);
  const std::vector<Eigen::MatrixXd> sets = {Waves(14, 4, .2), Waves(14, 2, .9)};
  for (int e = 0; e < 2; ++e) {
    for (int i = 0; i < 14; ++i) {
      for (int j = 0; j < 14; ++j) {
        const double square = (sets[e].row(i) - sets[e].row(j)).squaredNorm();
        k(i, j) += values[2 + e] * std::exp(-.5 * values[e] * square) +
                   values[4 + e] * sets[e].row(i).dot(sets[e].row(j));
      }
    }
  }
  k.diagonal().array() += AdditiveLikelihood::Noise(values);
  Eigen::MatrixXd solution;
  likelihood.Solve(Waves(14, 3, .4), solution);
  EXPECT_LT((k * solution - Waves(14, 3, .4)).norm(), 1e-9);
}

// Beyond the clamp the value stays, and only the prior leads a width back.
TEST(AdditiveLikelihoodTest, ClampedLogsFeelThePriorAlone) {
  AdditiveLikelihood free = MakeLikelihood(0), held = MakeLikelihood(.01);
  for (const double outside : {kMaxKernelLog + 1, kMaxKernelLog + 9}) {
    Eigen::VectorXd x = free.Start(), gradient;
    x[0] = outside;
    x[6] = -outside;
    ASSERT_TRUE(std::isfinite(free.Evaluate(x, &gradient)));
    EXPECT_EQ(gradient[0], 0);
    EXPECT_EQ(gradient[6], 0);
    EXPECT_NE(gradient[1], 0);
    const double away = outside - held.Start()[0];
    held.Evaluate(x, &gradient);
    EXPECT_NEAR(gradient[0], .01 * 14 * 5 * away, 1e-9 * away);
    EXPECT_EQ(gradient[6], 0);
  }
}

TEST(AdditiveLikelihoodTest, ACancelledOrBrokenEvaluationIsNotANumber) {
  const GramData data = *MakeGramData(Waves(14, 5, .7));
  AdditiveLikelihood cancelled({Waves(14, 4, .2)}, data, 0, Progress(nullptr, [] { return true; }));
  EXPECT_TRUE(std::isnan(cancelled.Evaluate(cancelled.Start(), nullptr)));
  // Rows a million times too long: rounding of the products is far above the noise.
  AdditiveLikelihood broken({1e9 * Waves(14, 2, .2)}, data, 0, {});
  Eigen::VectorXd x(5);
  x << 0, -14, 14, -14, -14;
  EXPECT_TRUE(std::isnan(broken.Evaluate(x, nullptr)));
}

}  // namespace
}  // namespace pleat
