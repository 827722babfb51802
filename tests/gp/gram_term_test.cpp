#include "pleat/gp/gram_term.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "pleat/optimize/objective.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// The covariance written out entry by entry.
Eigen::MatrixXd WrittenOutKernel(const Eigen::MatrixXd& x, const KernelOptions& options,
                                 const KernelLogs& logs) {
  const Eigen::Index n = x.rows();
  Eigen::MatrixXd k(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      k(i, j) = std::exp(logs.amplitude) *
                std::exp(-.5 * std::exp(logs.inverse_width) * (x.row(i) - x.row(j)).squaredNorm());
      if (options.bias) k(i, j) += std::exp(logs.bias);
      if (options.linear) k(i, j) += std::exp(logs.linear) * x.row(i).dot(x.row(j));
    }
    k(i, i) += std::exp(logs.noise) + options.relative_noise_floor * std::exp(logs.amplitude) +
               options.absolute_jitter;
  }
  return k;
}

// The Gram term over [X, logs].
class GramObjective : public Objective {
 public:
  GramObjective(GramData data, int dims, const KernelOptions& options, double weight)
      : data_(std::move(data)),
        rows_(static_cast<int>(data_.factor.rows())),
        dims_(dims),
        options_(options),
        weight_(weight),
        term_(rows_, options) {}
  int num_unknowns() const override { return rows_ * dims_ + NumKernelUnknowns(options_); }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    const int num_logs = NumKernelUnknowns(options_);
    const Eigen::MatrixXd inputs = Eigen::Map<const Eigen::MatrixXd>(x.data(), rows_, dims_);
    term_.SetInputs(inputs);
    const double value = term_.Evaluate(UnpackKernelLogs(options_, x.tail(num_logs)), data_,
                                        weight_, gradient != nullptr);
    if (gradient) {
      gradient->resize(num_unknowns());
      Eigen::MatrixXd input_gradient;
      term_.InputGradient(input_gradient);
      gradient->head(rows_ * dims_) = input_gradient.reshaped();
      gradient->tail(num_logs) = term_.log_gradient();
    }
    return value;
  }

 private:
  GramData data_;
  int rows_, dims_;
  KernelOptions options_;
  double weight_;
  GramTerm term_;
};

class GramTermTest : public ::testing::TestWithParam<KernelOptions> {};

TEST_P(GramTermTest, ValueIsTheLikelihoodWrittenOut) {
  const Eigen::MatrixXd x = RandomMatrix(31, 3, 1), y = RandomMatrix(31, 50, 2);
  const KernelLogs logs{-.4, .3, -1, -1.5, -.7};
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData data, MakeGramData(y));
  GramTerm term(31, GetParam());
  term.SetInputs(x);
  const double value = term.Evaluate(logs, data, .8, false);
  const Eigen::LLT<Eigen::MatrixXd> llt(WrittenOutKernel(x, GetParam(), logs));
  double log_determinant = 0;
  for (int i = 0; i < 31; ++i) log_determinant += 2 * std::log(llt.matrixLLT()(i, i));
  const double expected = .8 * (25 * log_determinant + .5 * (llt.solve(y).cwiseProduct(y)).sum());
  EXPECT_NEAR(value, expected, 1e-9 * std::abs(expected));
}

TEST_P(GramTermTest, GradientIsRight) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData wide, MakeGramData(RandomMatrix(17, 40, 2)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData narrow, MakeGramData(RandomMatrix(17, 5, 3)));
  EXPECT_TRUE(wide.lower_triangular);
  EXPECT_FALSE(narrow.lower_triangular);
  for (const GramData& data : {wide, narrow}) {
    GramObjective objective(data, 3, GetParam(), 1.7);
    Eigen::VectorXd x(objective.num_unknowns());
    x.head(51) = RandomMatrix(51, 1, 4);
    PackKernelLogs(GetParam(), {-.4, .3, -1, -1.5, -.7}, x.tail(NumKernelUnknowns(GetParam())));
    const GradientCheck check = CheckGradient(objective, x);
    EXPECT_LT(check.max_relative_error, 1e-5)
        << "unknown " << check.worst_unknown << ": " << check.analytic << " vs " << check.numeric;
  }
}

// As the noise falls, K^-1 grows and the two parts of the gradient cancel. Truth: 80-bit floats.
TEST_P(GramTermTest, GradientIsRightWithLittleNoise) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const int n = 60;
  Eigen::MatrixXd x(n, 2);  // a smooth curve, as motion is
  for (int i = 0; i < n; ++i) x.row(i) << std::sin(.05 * i), std::cos(.11 * i);
  KernelOptions options = GetParam();
  options.relative_noise_floor = options.absolute_jitter = 0;
  const KernelLogs logs{-.4, .3, -1, std::log(1e-5), -.7};
  const Eigen::MatrixXd y = WrittenOutKernel(x, options, logs) * RandomMatrix(n, 90, 2) * .1;
  const Matrix inverse = WrittenOutKernel(x, options, logs).cast<long double>().inverse();
  Matrix rbf = WrittenOutKernel(x, {.bias = false, .relative_noise_floor = 0},
                                {logs.inverse_width, logs.amplitude, 0, -1e9, 0})
                   .cast<long double>();
  rbf.diagonal().setConstant(std::exp(logs.amplitude));
  for (const int num_outputs : {90, 20}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const GramData data, MakeGramData(y.leftCols(num_outputs)));
    const Matrix factor = data.factor.cast<long double>();
    const Matrix solution = inverse * factor;
    const Matrix a = .5L * (num_outputs * inverse - solution * solution.transpose());
    const Matrix p = a.cwiseProduct(rbf), inputs = x.cast<long double>();
    const Matrix sums = p.rowwise().sum();
    Matrix truth =
        2 * std::exp(logs.inverse_width) * (p * inputs - (sums.col(0).asDiagonal() * inputs));
    if (options.linear) truth += 2 * std::exp(logs.linear) * a * inputs;
    GramTerm term(n, options);
    term.SetInputs(x);
    term.Evaluate(logs, data, 1, true);
    Eigen::MatrixXd gradient;
    term.InputGradient(gradient);
    EXPECT_LT((gradient.cast<long double>() - truth).norm(), 1e-6 * truth.norm()) << num_outputs;
    EXPECT_NEAR(term.log_gradient()[1], double(p.sum()), 1e-6 * double(p.cwiseAbs().sum()));
    const int noise = options.bias ? 3 : 2;
    EXPECT_NEAR(term.log_gradient()[noise], double(1e-5L * a.trace()),
                1e-6 * double(1e-5L * a.diagonal().cwiseAbs().sum()));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kernels, GramTermTest,
    ::testing::Values(KernelOptions{.bias = true, .linear = false},
                      KernelOptions{.bias = false, .linear = false, .relative_noise_floor = .05},
                      KernelOptions{.bias = true, .linear = true, .absolute_jitter = 1e-3},
                      KernelOptions{.bias = false, .linear = true}));

TEST(GramTermTest, DoesNotDependOnTheOrderOfOutputs) {
  const Eigen::MatrixXd x = RandomMatrix(20, 2, 1), y = RandomMatrix(20, 30, 2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData data, MakeGramData(y));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData reversed, MakeGramData(y.rowwise().reverse()));
  GramTerm term(20, {});
  term.SetInputs(x);
  const double value = term.Evaluate({}, data, 1, false);
  EXPECT_NEAR(term.Evaluate({}, reversed, 1, false), value, 1e-9 * std::abs(value));
}

TEST(GramTermTest, GramAloneGivesTheSameAsTheOutputs) {
  const Eigen::MatrixXd x = RandomMatrix(20, 2, 1), y = RandomMatrix(20, 12, 2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData narrow, MakeGramData(y));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData gram, MakeGramDataFromGram(y * y.transpose(), 12));
  GramTerm term(20, {});
  term.SetInputs(x);
  const double value = term.Evaluate({}, narrow, 1, false);
  EXPECT_NEAR(term.Evaluate({}, gram, 1, false), value, 1e-8 * std::abs(value));
}

TEST(GramTermTest, DuplicatedRowsWithoutNoiseNeedJitterAndGetIt) {
  Eigen::MatrixXd x = RandomMatrix(20, 2, 1);
  x.bottomRows(10) = x.topRows(10);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData data, MakeGramData(RandomMatrix(20, 4, 2)));
  GramTerm term(20, {.bias = true, .relative_noise_floor = 0});
  term.SetInputs(x);
  EXPECT_TRUE(std::isfinite(term.Evaluate({.noise = -1e9}, data, 1, true)));
}

TEST(GramTermTest, ClampedLogsHaveNoGradient) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData data, MakeGramData(RandomMatrix(10, 4, 2)));
  GramTerm term(10, {});
  term.SetInputs(RandomMatrix(10, 2, 1));
  const double value = term.Evaluate({.noise = -20}, data, 1, true);
  EXPECT_EQ(term.log_gradient()[3], 0);
  EXPECT_NE(term.log_gradient()[0], 0);
  EXPECT_EQ(term.Evaluate({.noise = -30}, data, 1, false), value);
}

// K^-1 of the last evaluation, in the three forms that callers take it in.
TEST_P(GramTermTest, SolutionsAndWhitenerAreOfTheSameMatrix) {
  const Eigen::MatrixXd x = RandomMatrix(31, 3, 1), y = RandomMatrix(31, 6, 2);
  const KernelLogs logs{-.4, .3, -1, -1.5, -.7};
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData data, MakeGramData(y));
  GramTerm term(31, GetParam());
  term.SetInputs(x);
  const double value = term.Evaluate(logs, data, 1, true);
  const Eigen::MatrixXd inverse = WrittenOutKernel(x, GetParam(), logs).inverse();
  Eigen::MatrixXd solution;
  term.Solve(y, solution);
  EXPECT_LT((solution - inverse * y).norm(), 1e-9 * solution.norm());
  const Eigen::MatrixXd whitener = term.whitener().triangularView<Eigen::Lower>();
  EXPECT_LT((whitener.transpose() * whitener - inverse).norm(), 1e-9 * inverse.norm());
  // The weight is a factor of everything.
  const Eigen::VectorXd logs_before = term.log_gradient();
  EXPECT_NEAR(term.Evaluate(logs, data, 2.5, true), 2.5 * value, 1e-9 * std::abs(value));
  EXPECT_LT((term.log_gradient() - 2.5 * logs_before).norm(), 1e-9 * logs_before.norm());
  EXPECT_LT((term.weighted_solution() - 2.5 * solution).norm(), 1e-9 * solution.norm());
}

// Two terms that share inputs and scratch give, in turn, what each gives alone.
TEST_P(GramTermTest, SharedMemoryChangesNothing) {
  const Eigen::MatrixXd x = RandomMatrix(20, 2, 1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData first, MakeGramData(RandomMatrix(20, 30, 2)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData second, MakeGramData(RandomMatrix(20, 4, 3)));
  GramTerm alone(20, GetParam()), a(20, GetParam()), b(20, GetParam());
  alone.SetInputs(x);
  b.ShareInputs(a);
  b.ShareScratch(a);
  a.SetInputs(x);
  for (const KernelLogs& logs : {KernelLogs{}, KernelLogs{.3, -.1, -1, -2, -1}}) {
    for (const auto& [term, data] : {std::pair(&a, &first), std::pair(&b, &second)}) {
      EXPECT_EQ(term->Evaluate(logs, *data, 1.3, true), alone.Evaluate(logs, *data, 1.3, true));
      EXPECT_EQ(term->log_gradient(), alone.log_gradient());
      Eigen::MatrixXd shared, own;
      term->InputGradient(shared);
      alone.InputGradient(own);
      EXPECT_EQ(shared, own);
    }
  }
}

TEST(GramTermTest, CancelledEvaluationIsNotANumber) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData data, MakeGramData(RandomMatrix(10, 4, 2)));
  GramTerm term(10, {});
  term.SetInputs(RandomMatrix(10, 2, 1));
  const Progress cancelled(nullptr, [] { return true; });
  EXPECT_TRUE(std::isnan(term.Evaluate({}, data, 1, true, cancelled)));
}

TEST(GramDataTest, RefusesWhatIsNoGramMatrix) {
  EXPECT_THAT(MakeGramDataFromGram(Eigen::MatrixXd::Zero(3, 4), 1),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not square")));
  Eigen::MatrixXd hole = Eigen::MatrixXd::Identity(3, 3);
  hole(2, 1) = std::nan("");
  EXPECT_THAT(MakeGramDataFromGram(hole, 1),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not finite")));
  EXPECT_THAT(MakeGramData(Eigen::MatrixXd::Constant(3, 3, 1e200)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not finite")));
  Eigen::MatrixXd indefinite = Eigen::MatrixXd::Identity(3, 3);
  indefinite(0, 0) = -.5;
  EXPECT_THAT(MakeGramDataFromGram(indefinite, 1),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("semidefinite")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GramData zero,
                             MakeGramDataFromGram(Eigen::MatrixXd::Zero(3, 3), 2));
  EXPECT_EQ(zero.factor.norm(), 0);
}

}  // namespace
}  // namespace pleat
