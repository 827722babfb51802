// What holds of every Gaussian process regression, whatever the data: identities of the posterior,
// what the noise floors stand for, and what must not matter.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "pleat/gp/gp_regression.h"
#include "support/gp_predictions.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr int kNumRows = 40, kNumInputs = 3;

class GpIdentitiesTest : public testing::TestWithParam<KernelOptions> {
 protected:
  GpRegression Condition(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                         bool normalize = true) const {
    return Condition(x, y, GetParam(), logs_, normalize);
  }
  static GpRegression Condition(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                                const KernelOptions& kernel, const KernelLogs& logs,
                                bool normalize) {
    return GpRegression::Condition(x, y, logs, {.kernel = kernel, .normalize_inputs = normalize})
        .value();
  }
  // The whole noise variance of `gp`, (normalized output unit)^2.
  static double Noise(const GpRegressionParameters& p) {
    const KernelValues values = KernelValuesOf(p.kernel_options, p.kernel);
    return values.s2 + p.kernel_options.relative_noise_floor * values.a +
           p.kernel_options.absolute_jitter;
  }
  static void ExpectSame(const GpPredictions& a, const GpPredictions& b, double tolerance) {
    EXPECT_LT((a.means - b.means).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LT((a.variances - b.variances).cwiseAbs().maxCoeff(), 10 * tolerance);  // float
  }

  const KernelLogs logs_{-.2, .3, -1, -3, -1.2};
  const Eigen::MatrixXd x_ = RandomMatrix(kNumRows, kNumInputs, 1);
  const Eigen::MatrixXd y_ = RandomMatrix(kNumRows, 2, 2);
  const Eigen::MatrixXd queries_ = 1.5 * RandomMatrix(12, kNumInputs, 3);
};

INSTANTIATE_TEST_SUITE_P(
    Kernels, GpIdentitiesTest,
    testing::Values(KernelOptions{.bias = true, .linear = true},
                    KernelOptions{.bias = false, .linear = false, .relative_noise_floor = .05},
                    KernelOptions{.bias = true, .linear = false, .absolute_jitter = .02}));

// With K^-1 = W^T W the posterior at a training row n has the mean y - s^2 K^-1 y and the variance
// s^2 - s^4 (K^-1)_nn: below the noise, as the row itself was seen.
TEST_P(GpIdentitiesTest, TrainingRowsAreKnownUpToTheNoise) {
  const GpRegression gp = Condition(x_, y_);
  const GpRegressionParameters& p = gp.parameters();
  const GpPredictions at_rows = PredictRows(gp, x_);
  const double noise = Noise(p), unit = p.output_scale * p.output_scale;
  const Eigen::MatrixXd residual = y_ - at_rows.means;
  EXPECT_LT((residual - noise * p.output_scale * p.alpha).cwiseAbs().maxCoeff(), 1e-9);
  for (int n = 0; n < kNumRows; ++n) {
    const double inverse = p.whitener.cast<double>().col(n).squaredNorm();
    EXPECT_NEAR(at_rows.variances[n], unit * (noise - noise * noise * inverse), 1e-4 * unit);
    EXPECT_LT(at_rows.variances[n], unit * noise);
    EXPECT_GT(at_rows.variances[n], 0);
  }
}

TEST_P(GpIdentitiesTest, EveryFurtherRowMakesTheVarianceSmallerEverywhere) {
  Eigen::VectorXd last;
  for (const int num_rows : {5, 10, 20, 40}) {
    const GpRegression gp = Condition(x_.topRows(num_rows), y_.topRows(num_rows), false);
    const double unit = std::pow(gp.parameters().output_scale, 2);
    const Eigen::VectorXd variances = PredictRows(gp, queries_).variances / unit;
    if (last.size() > 0) {
      EXPECT_LT((variances - last).maxCoeff(), 1e-5) << num_rows;
    }
    last = variances;
  }
}

// A row that was seen twice is as good as one with half of the noise.
TEST_P(GpIdentitiesTest, ARepeatedRowIsARowWithHalfTheNoise) {
  KernelOptions options = GetParam();
  options.relative_noise_floor = options.absolute_jitter = 0;
  Eigen::MatrixXd twice_x(2 * kNumRows, kNumInputs), twice_y(2 * kNumRows, 2);
  twice_x << x_, x_;
  twice_y << y_, y_;
  KernelLogs half = logs_;
  half.noise -= std::log(2);
  ExpectSame(PredictRows(Condition(twice_x, twice_y, options, logs_, true), queries_),
             PredictRows(Condition(x_, y_, options, half, true), queries_), 1e-6);
}

TEST_P(GpIdentitiesTest, FloorsAreNoiseOfTheirSize) {
  const GpRegression gp = Condition(x_, y_);
  KernelOptions without = GetParam();
  without.relative_noise_floor = without.absolute_jitter = 0;
  KernelLogs logs = logs_;
  logs.noise = std::log(Noise(gp.parameters()));
  ExpectSame(PredictRows(gp, queries_),
             PredictRows(Condition(x_, y_, without, logs, true), queries_), 1e-9);
}

// With the kernel given the mean is linear in the outputs, and the variance knows only their unit.
TEST_P(GpIdentitiesTest, MeansOfSumsAreSumsOfMeans) {
  const Eigen::MatrixXd other = 30 * RandomMatrix(kNumRows, 2, 5).array() + 7;
  const GpRegression a = Condition(x_, y_), b = Condition(x_, other);
  const GpRegression sum = Condition(x_, 2 * y_ - other);
  const GpPredictions of_a = PredictRows(a, queries_), of_b = PredictRows(b, queries_);
  const GpPredictions of_sum = PredictRows(sum, queries_);
  EXPECT_LT((of_sum.means - (2 * of_a.means - of_b.means)).cwiseAbs().maxCoeff(), 1e-8);
  const double ratio = b.parameters().output_scale / a.parameters().output_scale;
  EXPECT_LT((of_b.variances - ratio * ratio * of_a.variances).cwiseAbs().maxCoeff(),
            1e-9 * of_b.variances.maxCoeff());
  EXPECT_NEAR(b.prior_variance(), ratio * ratio * a.prior_variance(), 1e-9 * b.prior_variance());
}

// Only distances and products of centered inputs count, so neither the origin nor the axes do.
TEST_P(GpIdentitiesTest, OriginAxesAndOrderOfRowsDoNotMatter) {
  const Eigen::MatrixXd turn =
      Eigen::HouseholderQR<Eigen::MatrixXd>(RandomMatrix(kNumInputs, kNumInputs, 7)).householderQ();
  const Eigen::RowVectorXd shift = 100 * RandomMatrix(1, kNumInputs, 8);
  const auto moved = [&](const Eigen::MatrixXd& rows) {
    return Eigen::MatrixXd((5 * rows * turn).rowwise() + shift);
  };
  const GpPredictions expected = PredictRows(Condition(x_, y_), queries_);
  ExpectSame(PredictRows(Condition(moved(x_), y_), moved(queries_)), expected, 1e-6);
  ExpectSame(PredictRows(Condition(x_.colwise().reverse(), y_.colwise().reverse()), queries_),
             expected, 1e-6);
}

// A query is never lost to overflow: beyond the farthest distance only its direction counts.
TEST_P(GpIdentitiesTest, QueriesAtTheEndOfTheWorldAreFinite) {
  const GpRegression gp = Condition(x_, y_, false);
  const Eigen::RowVectorXd direction = RandomMatrix(1, kNumInputs, 9).row(0).normalized();
  const GpPredictions far = PredictRows(gp, 1e7 * direction);
  for (const double distance : {1e9, 1e150, 1e300}) {
    const GpPredictions farther = PredictRows(gp, distance * direction);
    EXPECT_LT((farther.means - far.means).norm(), 1e-9 * (1 + far.means.norm())) << distance;
    EXPECT_TRUE(std::isfinite(farther.variances[0])) << distance;
  }
}

// Nothing of one column can be told from rounding here: the kernel matrix is 1e22 times 1.
TEST(GpFactorizationTest, AKernelThatCannotBeFactoredIsToldWithARemedy) {
  const Eigen::MatrixXd x = 1e8 * Eigen::MatrixXd::Ones(8, 1);
  const KernelLogs logs{.amplitude = -kMaxKernelLog, .noise = -kMaxKernelLog, .linear = 13};
  const auto condition = [&](double relative_noise_floor, double absolute_jitter) {
    return GpRegression::Condition(x, RandomMatrix(8, 1, 1), logs,
                                   {.kernel = {.bias = false,
                                               .linear = true,
                                               .relative_noise_floor = relative_noise_floor,
                                               .absolute_jitter = absolute_jitter},
                                    .normalize_inputs = false});
  };
  EXPECT_THAT(condition(0, 0),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("raise the noise floor")));
  EXPECT_THAT(condition(0, 1e10), IsOk());
}

TEST(GpFactorizationTest, HyperparametersThatAreNotFiniteAreRefused) {
  const Eigen::MatrixXd x = RandomMatrix(5, 2, 1);
  for (double KernelLogs::*log : {&KernelLogs::inverse_width, &KernelLogs::amplitude,
                                  &KernelLogs::bias, &KernelLogs::noise, &KernelLogs::linear}) {
    for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      KernelLogs logs;
      logs.*log = wrong;
      EXPECT_THAT(GpRegression::Condition(x, x, logs),
                  HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("hyperparameter")));
    }
  }
}

}  // namespace
}  // namespace pleat
