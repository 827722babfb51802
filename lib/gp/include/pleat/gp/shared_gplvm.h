// The shared Gaussian process latent variable model with dynamics: one latent point per frame
// explains both the pose (Y_S) and the detail (Y_M) of that frame
// (docs/method/learner.md#shared-gplvm).
//
//   L = sum_v w_v [ D_v/2 log|K_v| + 1/2 tr(K_v^-1 G_v) ]                       v = S, M
//     + lambda [ q/2 log|K_d| + 1/2 tr(K_d^-1 X_o X_o^T) + 1/2 sum |x_first|^2 ] + P(theta)
//
// Source: the paper, section IV-B; dynamics: Wang, Fleet, Hertzmann, "Gaussian process dynamical
// models", NIPS 2005. Back-constraints: Lawrence, Quinonero-Candela, ICML 2006.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/gp/gram_term.h"
#include "pleat/gp/kernel.h"
#include "pleat/math/pca.h"
#include "pleat/optimize/objective.h"
#include "pleat/optimize/summary.h"

namespace pleat {

enum class Optimizer { kScg, kLbfgs };

// How the columns of a view are scaled before training. They are always centered.
enum class ViewScaling {
  kOneScalar,  // one scalar per view, mean square 1: still vertices stay quiet
               // Every column to unit variance (N - 1), as docs/method/learner.md#check-values has
               // it.
  kPerColumn,
};

struct SharedGplvmOptions {
  int latent_dimension = 8;      // q
  double pose_weight = 1;        // w_S
  double detail_weight = 1;      // w_M
  double dynamics_weight = 1;    // lambda; 0 turns the dynamics off
  int dynamics_order = 1;        // 1: x_t from x_(t-1); 2: from x_(t-1) and x_(t-2)
  bool dynamics_linear = false;  // adds a linear term to the dynamics kernel

  // With back-constraints latent points are a smooth function of the pose, X = K_b A, where K_b is
  // an RBF kernel on Y_S of `back_width` times its median distance (plus `back_noise` on the
  // diagonal where it has to be inverted). Free latent points over-fit.
  bool back_constraints = true;
  double back_width = 1;
  double back_noise = 1e-3;

  // The precision of a Gaussian prior, per training frame and output, on log g around log(1 /
  // median squared distance at the start) and on log a around 0; 0: no prior.
  double prior_precision = 0;

  double relative_noise_floor = 1e-6;  // for all kernels, see KernelOptions
  double absolute_jitter = 0;

  ViewScaling scaling = ViewScaling::kOneScalar;
  Optimizer optimizer = Optimizer::kScg;
  int max_iterations = 100;

  // The published learner. q was lost from the text of the paper (4 to 6 fits what is left); the
  // dynamics are first order, the start is the PCA of Y_S alone, 100 iterations of SCG.
  static SharedGplvmOptions Paper();
};

struct SharedGplvmSummary {
  OptimizationSummary optimization;
  double pose_scale = 1, detail_scale = 1;  // what the views were divided by (kOneScalar)
};

// The result of training. Everything refers to centered and scaled views.
struct SharedGplvm {
  Eigen::MatrixXd latents;  // X, N x q
  KernelLogs pose_kernel, detail_kernel, dynamics_kernel;
  KernelOptions pose_options, detail_options, dynamics_options;
  double detail_scale = 1;  // detail_kernel's output unit in the unit of Y_M (kOneScalar)

  // Filled only with back-constraints: X = K_b A with inputs Y_S as given, centered.
  Eigen::MatrixXd back_weights;       // A, N x q
  double back_log_inverse_width = 0;  // log g of K_b, 1 / (unit of Y_S)^2
};

// L and its gradient over [X or A (column-major), pose logs, detail logs, dynamics logs]. It keeps
// its working memory, so one objective serves one thread.
class SharedGplvmObjective : public Objective {
 public:
  // The views are scaled as wanted already. `clip_starts`: the first row of each clip, rising, the
  // first 0. `back_kernel`: K_b (N x N), empty without back-constraints. `prior_center`: log g of
  // the prior.
  SharedGplvmObjective(GramData pose, GramData detail, std::vector<int> clip_starts,
                       Eigen::MatrixXd back_kernel, double prior_center,
                       const SharedGplvmOptions& options, Progress progress = {});
  ~SharedGplvmObjective() override;

  int num_unknowns() const override;
  double Evaluate(const Eigen::VectorXd& unknowns, Eigen::VectorXd* gradient) override;

  // Convert latent points (N x q) or back weights, and logs, to unknowns, and back.
  Eigen::VectorXd Pack(const Eigen::MatrixXd& latents_or_weights, const KernelLogs& pose,
                       const KernelLogs& detail, const KernelLogs& dynamics) const;
  void Unpack(const Eigen::VectorXd& unknowns, SharedGplvm* model) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The details as training sees them: Y Y^T of the centered outputs (N x N) and their number.
struct DetailView {
  Eigen::MatrixXd gram;    // N x N, of the centered (not scaled) outputs
  double num_outputs = 0;  // D_M
};

// Returns the Gram matrix of the centered (and with kPerColumn scaled) columns of `outputs` (N x
// D_M).
DetailView MakeDetailView(const Eigen::Ref<const Eigen::MatrixXd>& outputs, ViewScaling scaling);
// Returns the same for the rows `rows` of `outputs`. What the components leave out is taken to be
// spread evenly over the rows: without it the noise would be learned too small.
DetailView MakeDetailView(const PrincipalComponents& outputs, const std::vector<Eigen::Index>& rows,
                          ViewScaling scaling);

// Trains on N frames: `poses` is Y_S (N x D_S). The error is kInvalidArgument for sizes that do not
// agree, values that are not finite or fewer than two frames, and kCancelled. `summary` may be
// null.
absl::StatusOr<SharedGplvm> TrainSharedGplvm(const Eigen::Ref<const Eigen::MatrixXd>& poses,
                                             const DetailView& details,
                                             const std::vector<int>& clip_starts,
                                             const SharedGplvmOptions& options = {},
                                             SharedGplvmSummary* summary = nullptr,
                                             const Progress& progress = {});

}  // namespace pleat
