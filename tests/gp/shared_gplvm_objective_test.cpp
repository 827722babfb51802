// The value of the objective, term by term, against the formula of shared_gplvm.h written out with
// dense matrices. Its gradients are in shared_gplvm_test.cpp.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "pleat/gp/shared_gplvm.h"
#include "support/random_data.h"

namespace pleat {
namespace {

constexpr int kNumSamples = 12, kLatents = 2;

SharedGplvmOptions Options() {
  SharedGplvmOptions options = SharedGplvmOptions::Paper();
  options.latent_dimension = kLatents;
  options.pose_weight = .7;
  options.detail_weight = 1.4;
  options.dynamics_weight = 2.5;
  options.prior_precision = 0;
  return options;
}

// 1/2 (D log|K| + tr(K^-1 Y Y^T)) for the kernel a exp(-g/2 d^2) + b + c x.x' + noise.
double ViewTerm(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y, const KernelOptions& options,
                const KernelLogs& logs) {
  const KernelValues v = KernelValuesOf(options, logs);
  Eigen::MatrixXd k(x.rows(), x.rows());
  for (int i = 0; i < x.rows(); ++i) {
    for (int j = 0; j < x.rows(); ++j) {
      k(i, j) = v.a * std::exp(-.5 * v.g * (x.row(i) - x.row(j)).squaredNorm());
      if (options.bias) k(i, j) += v.b;
      if (options.linear) k(i, j) += v.c * x.row(i).dot(x.row(j));
    }
  }
  k.diagonal().array() += v.s2 + options.relative_noise_floor * v.a + options.absolute_jitter;
  const Eigen::LLT<Eigen::MatrixXd> factor(k);
  const Eigen::MatrixXd l = factor.matrixL();
  const double log_determinant = 2 * l.diagonal().array().log().sum();
  return .5 *
         (static_cast<double>(y.cols()) * log_determinant + y.cwiseProduct(factor.solve(y)).sum());
}

class SharedGplvmFormulaTest : public testing::Test {
 protected:
  double Value(const SharedGplvmOptions& options, const std::vector<int>& clip_starts = {0, 5},
               const Eigen::MatrixXd& back_kernel = {}) const {
    SharedGplvmObjective objective(MakeGramData(poses_).value(), MakeGramData(details_).value(),
                                   clip_starts, back_kernel, 0, options);
    return objective.Evaluate(objective.Pack(latents_, pose_, detail_, dynamics_), nullptr);
  }
  // The kernels' options as training would hand them on.
  SharedGplvm Model(const SharedGplvmOptions& options) const {
    SharedGplvmObjective objective(MakeGramData(poses_).value(), MakeGramData(details_).value(),
                                   {0, 5}, {}, 0, options);
    SharedGplvm model;
    objective.Unpack(objective.Pack(latents_, pose_, detail_, dynamics_), &model);
    return model;
  }

  const Eigen::MatrixXd poses_ = RandomMatrix(kNumSamples, 4, 1);
  const Eigen::MatrixXd details_ = RandomMatrix(kNumSamples, 9, 2);
  const Eigen::MatrixXd latents_ = RandomMatrix(kNumSamples, kLatents, 3);
  const KernelLogs pose_{-.3, .2, -1, -1.5, 0};
  const KernelLogs detail_{.1, -.4, -1.2, -1.1, 0};
  const KernelLogs dynamics_{-.5, .3, 0, -1.3, -.8};
};

TEST_F(SharedGplvmFormulaTest, IsTheFormulaTermByTerm) {
  SharedGplvmOptions options = Options();
  const SharedGplvm model = Model(options);
  SharedGplvmOptions without = options;
  without.dynamics_weight = 0;
  const double views = .7 * ViewTerm(latents_, poses_, model.pose_options, pose_) +
                       1.4 * ViewTerm(latents_, details_, model.detail_options, detail_);
  const double value = Value(without);
  // Without dynamics a prior on the logs may remain; with weights doubled only the views change.
  SharedGplvmOptions doubled = without;
  doubled.pose_weight *= 2;
  doubled.detail_weight *= 2;
  EXPECT_NEAR(Value(doubled) - value, views, 1e-8 * std::abs(views));
}

TEST_F(SharedGplvmFormulaTest, DynamicsAreOneMoreViewPlusThePriorOfFirstFrames) {
  SharedGplvmOptions options = Options();
  const SharedGplvm model = Model(options);
  Eigen::MatrixXd inputs(kNumSamples - 2, kLatents), outputs(kNumSamples - 2, kLatents);
  int row = 0;
  for (int t = 0; t < kNumSamples; ++t) {
    if (t == 0 || t == 5) continue;  // the clips begin here
    inputs.row(row) = latents_.row(t - 1);
    outputs.row(row++) = latents_.row(t);
  }
  const double dynamics = ViewTerm(inputs, outputs, model.dynamics_options, dynamics_) +
                          .5 * (latents_.row(0).squaredNorm() + latents_.row(5).squaredNorm());
  SharedGplvmOptions doubled = options;
  doubled.dynamics_weight *= 2;
  EXPECT_NEAR(Value(doubled) - Value(options), 2.5 * dynamics, 1e-8 * std::abs(dynamics));
}

// Nobody can tell where the latent space points: a rotation of all points changes nothing.
TEST_F(SharedGplvmFormulaTest, TurningTheLatentSpaceChangesNothing) {
  const double angle = .7;
  Eigen::Matrix2d turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  for (const bool linear : {false, true}) {
    SharedGplvmOptions options = Options();
    options.dynamics_linear = linear;
    SharedGplvmObjective objective(MakeGramData(poses_).value(), MakeGramData(details_).value(),
                                   {0, 5}, {}, 0, options);
    const double before =
        objective.Evaluate(objective.Pack(latents_, pose_, detail_, dynamics_), nullptr);
    const double after =
        objective.Evaluate(objective.Pack(latents_ * turn, pose_, detail_, dynamics_), nullptr);
    EXPECT_NEAR(after, before, 1e-9 * std::abs(before));
  }
}

// With X = K_b A the value is that of the free points K_b A.
TEST_F(SharedGplvmFormulaTest, BackConstraintsAreAChangeOfUnknowns) {
  const Eigen::MatrixXd r = RandomMatrix(kNumSamples, kNumSamples, 9);
  const Eigen::MatrixXd back_kernel =
      (r + r.transpose()) / kNumSamples + Eigen::MatrixXd::Identity(kNumSamples, kNumSamples);
  SharedGplvmObjective constrained(MakeGramData(poses_).value(), MakeGramData(details_).value(),
                                   {0, 5}, back_kernel, 0, Options());
  SharedGplvmObjective free(MakeGramData(poses_).value(), MakeGramData(details_).value(), {0, 5},
                            {}, 0, Options());
  const double a =
      constrained.Evaluate(constrained.Pack(latents_, pose_, detail_, dynamics_), nullptr);
  const double b =
      free.Evaluate(free.Pack(back_kernel * latents_, pose_, detail_, dynamics_), nullptr);
  EXPECT_NEAR(a, b, 1e-9 * std::abs(b));
}

TEST_F(SharedGplvmFormulaTest, PackAndUnpackAreInverse) {
  const SharedGplvm model = Model(Options());
  EXPECT_EQ(model.latents, latents_);
  EXPECT_EQ(model.pose_kernel.inverse_width, pose_.inverse_width);
  EXPECT_EQ(model.detail_kernel.noise, detail_.noise);
  EXPECT_EQ(model.dynamics_kernel.amplitude, dynamics_.amplitude);
}

}  // namespace
}  // namespace pleat
