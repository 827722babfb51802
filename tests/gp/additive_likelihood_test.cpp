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

}  // namespace
}  // namespace pleat
