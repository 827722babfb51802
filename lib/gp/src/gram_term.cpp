#include "pleat/gp/gram_term.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "pleat/simd/dense.h"

namespace pleat {
namespace {

constexpr double kLargestJitter = 1e-3;  // share of the RBF amplitude
constexpr double kFirstJitter = 1e-8;

}  // namespace

// What does not depend on the hyperparameters; terms with the same inputs share it.
struct GramInputs {
  Eigen::MatrixXd inputs;     // N x Q
  Eigen::MatrixXd extended;   // N x (Q + 1): inputs and a column of ones
  Eigen::MatrixXd distances;  // N x N, lower: R
  Eigen::MatrixXd products;   // N x N, lower: X X^T; only with a linear term
};

// What an evaluation works in. Each matrix holds several things one after the other, since the
// memory traffic of N x N matrices is what an evaluation spends its time on.
struct GramMatrices {
  Eigen::MatrixXd kernel;    // N x N, lower: K, then L, then A, then (not linear) P = A o K0
  Eigen::MatrixXd whitener;  // N x N, lower: W = L^-1
};

struct GramTerm::State {
  KernelOptions options;
  std::shared_ptr<DenseSolver> scratch = std::make_shared<DenseSolver>();
  DenseSolver& solver() { return *scratch; }
  Eigen::Index n = 0;

  std::shared_ptr<GramInputs> in = std::make_shared<GramInputs>();
  std::shared_ptr<GramMatrices> work = std::make_shared<GramMatrices>();
  Eigen::MatrixXd solution;  // N x r: K^-1 F, then weighted; only of a narrow F
  Eigen::MatrixXd beside;    // N x N, lower: P where A is needed too; only with a linear term
  Eigen::MatrixXd product;   // N x (Q + 1): scratch of InputGradient
  Eigen::VectorXd log_gradient;
  KernelValues values{};
  double log_determinant = 0;
  double relative_floor = 0;  // noise floor + jitter of the last factorization, share of a

  Eigen::MatrixXd& weighted() { return options.linear ? beside : work->kernel; }
  bool Factor();
  void Gradient(const KernelLogs& logs, const GramData& data, double weight);
};

// Computes K and its inverse factor from the distances, with more jitter until K is positive
// definite. K is formed anew each time, as a failed factorization leaves it half overwritten.
bool GramTerm::State::Factor() {
  const double* linear = options.linear ? in->products.data() : nullptr;
  for (double jitter = 0; jitter <= kLargestJitter;
       jitter = jitter == 0 ? kFirstJitter : 10 * jitter) {
    relative_floor = options.relative_noise_floor + jitter;
    solver().ops().kernel(in->distances.data(), linear, n, values.g, values.a, values.b, values.c,
                          work->kernel.data());
    work->kernel.diagonal().array() +=
        values.s2 + relative_floor * values.a + options.absolute_jitter;
    if (solver().FactorAndInvert(work->kernel, work->whitener)) {
      log_determinant = 2 * work->kernel.diagonal().array().log().sum();
      return std::isfinite(log_determinant);
    }
  }
  return false;
}

void GramTerm::State::Gradient(const KernelLogs& logs, const GramData& data, double weight) {
  solver().Gradient(work->whitener, data.num_outputs, solution, work->kernel);
  if (!data.lower_triangular) solution *= weight;
  const GramSums sums = solver().ops().gram_gradient(
      work->kernel.data(), in->distances.data(), options.linear ? in->products.data() : nullptr, n,
      values.g, values.a, .5 * weight, weighted().data());
  KernelLogs gradient;
  gradient.inverse_width = -.5 * values.g * sums.distance;
  gradient.amplitude = sums.amplitude + relative_floor * values.a * sums.trace;
  gradient.bias = values.b * sums.total;
  gradient.noise = values.s2 * sums.trace;
  gradient.linear = values.c * sums.linear;
  PackKernelLogs(options, gradient, log_gradient);
  Eigen::VectorXd unknowns(log_gradient.size());
  PackKernelLogs(options, logs, unknowns);
  for (Eigen::Index i = 0; i < unknowns.size(); ++i) {
    if (std::abs(unknowns[i]) > kMaxKernelLog) log_gradient[i] = 0;
  }
}

GramTerm::GramTerm(int num_rows, const KernelOptions& options) : state_(new State) {
  State& s = *state_;
  s.options = options;
  s.n = num_rows;
  for (Eigen::MatrixXd* m : {&s.in->distances, &s.work->kernel, &s.work->whitener}) {
    m->setZero(s.n, s.n);
  }
  if (options.linear) s.in->products = s.beside = s.in->distances;
  s.log_gradient.setZero(NumKernelUnknowns(options));
}

GramTerm::~GramTerm() = default;
GramTerm::GramTerm(GramTerm&&) noexcept = default;
GramTerm& GramTerm::operator=(GramTerm&&) noexcept = default;

void GramTerm::SetInputs(const Eigen::Ref<const Eigen::MatrixXd>& inputs) {
  State& s = *state_;
  GramInputs& in = *s.in;
  in.inputs = inputs;
  in.extended.resize(s.n, inputs.cols() + 1);
  in.extended << inputs, Eigen::VectorXd::Ones(s.n);
  s.solver().ops().squared_distances(in.inputs.data(), s.n, inputs.cols(), in.distances.data());
  if (s.options.linear) s.solver().OuterProduct(in.inputs, in.products);
}

void GramTerm::ShareInputs(const GramTerm& other) {
  assert(other.state_->n == state_->n && other.state_->options.linear == state_->options.linear);
  state_->in = other.state_->in;
}

void GramTerm::ShareScratch(const GramTerm& other) {
  state_->scratch = other.state_->scratch;
  if (other.state_->n == state_->n) state_->work = other.state_->work;
}

double GramTerm::Evaluate(const KernelLogs& logs, const GramData& data, double weight,
                          bool with_gradient, const Progress& progress) {
  State& s = *state_;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  s.values = KernelValuesOf(s.options, logs);
  if (progress.cancelled() || !s.Factor() || progress.cancelled()) return kNone;
  const double trace = s.solver().Whiten(s.work->whitener, data.factor, data.lower_triangular);
  const double value = .5 * weight * (data.num_outputs * s.log_determinant + trace);
  if (with_gradient) {
    if (progress.cancelled()) return kNone;
    s.Gradient(logs, data, weight);
  }
  return value;
}

const Eigen::VectorXd& GramTerm::log_gradient() const { return state_->log_gradient; }

void GramTerm::InputGradient(Eigen::MatrixXd& gradient) {
  State& s = *state_;
  const GramInputs& in = *s.in;
  const Eigen::Index dims = in.inputs.cols();
  // The gradient -2 g (diag(P 1) - P) X; the column of ones in `extended` gives P 1 in the same
  // product.
  s.solver().SymmetricMultiply(s.weighted(), in.extended, s.product);
  gradient =
      2 * s.values.g * (s.product.leftCols(dims) - s.product.col(dims).asDiagonal() * in.inputs);
  if (!s.options.linear) return;
  s.solver().SymmetricMultiply(s.work->kernel, in.inputs, s.product);
  gradient += 2 * s.values.c * s.product;
}

const Eigen::MatrixXd& GramTerm::weighted_solution() const { return state_->solution; }

void GramTerm::Solve(const Eigen::MatrixXd& right, Eigen::MatrixXd& solution) {
  State& s = *state_;
  Eigen::MatrixXd whitened;
  s.solver().MultiplyByFactor(s.work->whitener, false, right, whitened);
  s.solver().MultiplyByFactor(s.work->whitener, true, whitened, solution);
}

const Eigen::MatrixXd& GramTerm::whitener() const { return state_->work->whitener; }

absl::StatusOr<GramData> MakeGramDataFromGram(const Eigen::Ref<const Eigen::MatrixXd>& gram,
                                              double num_outputs) {
  const Eigen::Index n = gram.rows();
  if (gram.cols() != n || !gram.allFinite()) {
    return absl::InvalidArgumentError(
        absl::StrCat("the Gram matrix (", n, " x ", gram.cols(), ") is not square or not finite"));
  }
  const double scale = n > 0 ? gram.diagonal().mean() : 0;
  GramData data;
  data.lower_triangular = true;
  data.num_outputs = num_outputs;
  if (!(scale > 0)) {
    data.factor.setZero(n, n);
    return data;
  }
  DenseSolver solver;
  Eigen::MatrixXd unused;
  // Centered data make the Gram matrix singular. The ridge is the least that lets it be factored,
  // far below any noise that is learned.
  for (double ridge = 1e-12; ridge < 1e-5; ridge *= 10) {
    data.factor = gram;
    data.factor.diagonal().array() += ridge * scale;
    if (!solver.FactorAndInvert(data.factor, unused)) continue;
    data.factor.triangularView<Eigen::StrictlyUpper>().setZero();
    return data;
  }
  return absl::InvalidArgumentError("the Gram matrix is not positive semidefinite");
}

absl::StatusOr<GramData> MakeGramData(const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  // A narrow Y is its own factor, with fewer columns than a Cholesky factor has.
  if (outputs.cols() < outputs.rows()) return GramData{outputs, false, double(outputs.cols())};
  const Eigen::Index n = outputs.rows();
  DenseSolver solver;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  const DenseView view{outputs.data(), 1, outputs.outerStride()};
  solver.MultiplyRows(
      view, view, outputs.cols(),
      {.c = gram.data(), .ldc = n, .m = n, .n = n, .part = DensePart::kLower, .overwrite = true});
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return MakeGramDataFromGram(gram, static_cast<double>(outputs.cols()));
}

}  // namespace pleat
