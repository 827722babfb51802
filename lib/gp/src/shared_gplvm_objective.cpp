// L is a sum of three terms of one kind, a Gram term (gram_term.h) each: the poses given X, the
// details given X, and the dynamics, rows x_t given the rows x_(t-1) before them. The first two
// have fixed outputs and the unknown X as input. In the third both inputs and outputs are rows of
// X. So the gradient by X collects
//
//   from each view      the input gradient of its term,
//   from the dynamics   the input gradient on the rows before, lambda K_d^-1 X_o on rows t,
//   from the prior      lambda x_t on the first rows of each clip, which nothing predicts,
//
// and with back-constraints X = K_b A it becomes dL/dA = K_b^T dL/dX. No row of the dynamics
// straddles two clips (dynamics.h). The public reference codes get parts of these sums wrong in
// ways that still train to something plausible (docs/method/learner.md#gradients); the tests
// therefore use two clips and a weight lambda other than 1.
//
// Time goes into N x N matrices, hence memory is shared. Both views have the same inputs, so their
// distances are computed once (ShareInputs; setting those of the pose term sets the detail's). All
// terms work in the same scratch (ShareScratch), which stays in the cache. The price is an order:
// what a term has left in the scratch lasts until the next one is evaluated, so each term's
// gradient by its inputs is taken directly after its evaluation, in EvaluateView and
// EvaluateDynamics.
//
// The unknowns are one vector, [X or A by columns | pose logs | detail logs | dynamics logs]; the
// logs are those that the kernels have, in the order of PackKernelLogs. Where a kernel matrix
// cannot be factored, or training was cancelled, the value is NaN, the terms that follow are
// skipped, and the gradient has no meaning; optimizers look at the value first.

#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "dynamics.h"
#include "pleat/gp/shared_gplvm.h"

namespace pleat {
namespace {

KernelOptions ViewKernel(const SharedGplvmOptions& options) {
  return {.bias = true,
          .linear = false,
          .relative_noise_floor = options.relative_noise_floor,
          .absolute_jitter = options.absolute_jitter};
}

KernelOptions DynamicsKernel(const SharedGplvmOptions& options) {
  return {.bias = false,
          .linear = options.dynamics_linear,
          .relative_noise_floor = options.relative_noise_floor,
          .absolute_jitter = options.absolute_jitter};
}

// Returns the prior on (log g, log a), and adds its derivatives to `gradient` (of the logs) unless
// that is null.
double Prior(const KernelLogs& logs, double precision, double center, double* gradient) {
  const double width = logs.inverse_width - center, amplitude = logs.amplitude;
  if (gradient) {
    gradient[0] += precision * width;
    gradient[1] += precision * amplitude;
  }
  return .5 * precision * (width * width + amplitude * amplitude);
}

}  // namespace

struct SharedGplvmObjective::State {
  // One view: its data and its term of L.
  struct View {
    GramTerm term;
    GramData data;
    double weight;
  };

  SharedGplvmOptions options;
  KernelOptions view_kernel, dynamics_kernel;
  View pose, detail;
  DynamicsRows rows;
  GramTerm dynamics;
  GramData dynamics_data;
  Eigen::MatrixXd back_kernel;
  double prior_center;
  Progress progress;
  Eigen::Index n, q;

  Eigen::MatrixXd latents, latent_gradient;  // N x q
  Eigen::MatrixXd inputs;                    // N_d x order q
  Eigen::MatrixXd term_gradient;             // gradient of one term

  State(GramData pose_data, GramData detail_data, DynamicsRows dynamics_rows,
        const SharedGplvmOptions& o)
      : options(o),
        view_kernel(ViewKernel(o)),
        dynamics_kernel(DynamicsKernel(o)),
        pose{GramTerm(pose_data.factor.rows(), view_kernel), std::move(pose_data), o.pose_weight},
        detail{GramTerm(detail_data.factor.rows(), view_kernel), std::move(detail_data),
               o.detail_weight},
        rows(std::move(dynamics_rows)),
        dynamics(static_cast<int>(rows.targets.size()), dynamics_kernel) {
    detail.term.ShareInputs(pose.term);
    detail.term.ShareScratch(pose.term);
    dynamics.ShareScratch(pose.term);
  }

  bool has_dynamics() const { return options.dynamics_weight > 0; }
  int num_view_logs() const { return NumKernelUnknowns(view_kernel); }
  int num_dynamics_logs() const { return has_dynamics() ? NumKernelUnknowns(dynamics_kernel) : 0; }

  double EvaluateView(View& view, const Eigen::VectorXd& unknowns, Eigen::Index at,
                      Eigen::VectorXd* gradient);
  double EvaluateDynamics(const Eigen::VectorXd& unknowns, Eigen::Index at,
                          Eigen::VectorXd* gradient);
};

double SharedGplvmObjective::State::EvaluateView(View& view, const Eigen::VectorXd& unknowns,
                                                 Eigen::Index at, Eigen::VectorXd* gradient) {
  const int num_logs = num_view_logs();
  const KernelLogs logs = UnpackKernelLogs(view_kernel, unknowns.segment(at, num_logs));
  double value = view.term.Evaluate(logs, view.data, view.weight, gradient != nullptr, progress);
  if (!std::isfinite(value)) return std::numeric_limits<double>::quiet_NaN();
  const double precision = options.prior_precision * view.data.num_outputs * double(n);
  if (!gradient) return value + Prior(logs, precision, prior_center, nullptr);
  gradient->segment(at, num_logs) = view.term.log_gradient();
  view.term.InputGradient(term_gradient);
  latent_gradient += term_gradient;
  return value + Prior(logs, precision, prior_center, gradient->data() + at);
}

double SharedGplvmObjective::State::EvaluateDynamics(const Eigen::VectorXd& unknowns,
                                                     Eigen::Index at, Eigen::VectorXd* gradient) {
  const double lambda = options.dynamics_weight;
  double value = 0;
  for (const int t : rows.firsts) {
    value += .5 * lambda * latents.row(t).squaredNorm();
    if (gradient) latent_gradient.row(t) += lambda * latents.row(t);
  }
  const int num_logs = num_dynamics_logs();
  if (gradient) gradient->segment(at, num_logs).setZero();
  if (rows.targets.empty()) return value;
  const KernelLogs logs = UnpackKernelLogs(dynamics_kernel, unknowns.segment(at, num_logs));
  rows.Gather(latents, &inputs, &dynamics_data.factor);
  dynamics_data.num_outputs = double(q);
  dynamics.SetInputs(inputs);
  value += dynamics.Evaluate(logs, dynamics_data, lambda, gradient != nullptr, progress);
  if (!gradient || !std::isfinite(value)) return value;
  gradient->segment(at, num_logs) = dynamics.log_gradient();
  dynamics.InputGradient(term_gradient);
  rows.Scatter(term_gradient, dynamics.weighted_solution(), 1, &latent_gradient);
  return value;
}

SharedGplvmObjective::SharedGplvmObjective(GramData pose, GramData detail,
                                           std::vector<int> clip_starts,
                                           Eigen::MatrixXd back_kernel, double prior_center,
                                           const SharedGplvmOptions& options, Progress progress) {
  const int n = static_cast<int>(pose.factor.rows());
  assert(detail.factor.rows() == n && options.latent_dimension > 0);
  state_ =
      std::make_unique<State>(std::move(pose), std::move(detail),
                              MakeDynamicsRows(clip_starts, n, options.dynamics_order), options);
  state_->back_kernel = std::move(back_kernel);
  state_->prior_center = prior_center;
  state_->progress = std::move(progress);
  state_->n = n;
  state_->q = options.latent_dimension;
}

SharedGplvmObjective::~SharedGplvmObjective() = default;

int SharedGplvmObjective::num_unknowns() const {
  const State& s = *state_;
  return static_cast<int>(s.n * s.q) + 2 * s.num_view_logs() + s.num_dynamics_logs();
}

double SharedGplvmObjective::Evaluate(const Eigen::VectorXd& unknowns, Eigen::VectorXd* gradient) {
  State& s = *state_;
  const Eigen::Index num_points = s.n * s.q, num_logs = s.num_view_logs();
  const Eigen::Map<const Eigen::MatrixXd> points(unknowns.data(), s.n, s.q);
  const bool constrained = s.back_kernel.size() > 0;
  if (constrained) {
    s.latents.noalias() = s.back_kernel * points;
  } else {
    s.latents = points;
  }
  s.pose.term.SetInputs(s.latents);  // sets the detail's as well
  s.latent_gradient.setZero(s.n, s.q);
  if (gradient) gradient->resize(num_unknowns());

  double value = s.EvaluateView(s.pose, unknowns, num_points, gradient);
  if (std::isfinite(value)) {
    value += s.EvaluateView(s.detail, unknowns, num_points + num_logs, gradient);
  }
  if (std::isfinite(value) && s.has_dynamics()) {
    value += s.EvaluateDynamics(unknowns, num_points + 2 * num_logs, gradient);
  }
  if (!gradient) return value;
  Eigen::Map<Eigen::MatrixXd> point_gradient(gradient->data(), s.n, s.q);
  if (constrained) {
    point_gradient.noalias() = s.back_kernel.transpose() * s.latent_gradient;
  } else {
    point_gradient = s.latent_gradient;
  }
  return value;
}

Eigen::VectorXd SharedGplvmObjective::Pack(const Eigen::MatrixXd& latents_or_weights,
                                           const KernelLogs& pose, const KernelLogs& detail,
                                           const KernelLogs& dynamics) const {
  const State& s = *state_;
  assert(latents_or_weights.rows() == s.n && latents_or_weights.cols() == s.q);
  Eigen::VectorXd unknowns(num_unknowns());
  Eigen::Map<Eigen::MatrixXd>(unknowns.data(), s.n, s.q) = latents_or_weights;
  const int num_logs = s.num_view_logs();
  Eigen::Index at = s.n * s.q;
  PackKernelLogs(s.view_kernel, pose, unknowns.segment(at, num_logs));
  PackKernelLogs(s.view_kernel, detail, unknowns.segment(at + num_logs, num_logs));
  if (s.has_dynamics()) {
    PackKernelLogs(s.dynamics_kernel, dynamics,
                   unknowns.segment(at + 2 * num_logs, s.num_dynamics_logs()));
  }
  return unknowns;
}

void SharedGplvmObjective::Unpack(const Eigen::VectorXd& unknowns, SharedGplvm* model) const {
  const State& s = *state_;
  const Eigen::Map<const Eigen::MatrixXd> points(unknowns.data(), s.n, s.q);
  if (s.back_kernel.size() > 0) {
    model->back_weights = points;
    model->latents = s.back_kernel * points;
  } else {
    model->latents = points;
  }
  const int num_logs = s.num_view_logs();
  const Eigen::Index at = s.n * s.q;
  model->pose_options = model->detail_options = s.view_kernel;
  model->dynamics_options = s.dynamics_kernel;
  model->pose_kernel = UnpackKernelLogs(s.view_kernel, unknowns.segment(at, num_logs));
  model->detail_kernel = UnpackKernelLogs(s.view_kernel, unknowns.segment(at + num_logs, num_logs));
  if (s.has_dynamics()) {
    model->dynamics_kernel = UnpackKernelLogs(
        s.dynamics_kernel, unknowns.segment(at + 2 * num_logs, s.num_dynamics_logs()));
  }
}

}  // namespace pleat
