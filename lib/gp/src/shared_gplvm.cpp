#include "pleat/gp/shared_gplvm.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/gp/scaling.h"
#include "pleat/math/clip_starts.h"
#include "pleat/math/pca.h"
#include "pleat/optimize/lbfgs.h"
#include "pleat/optimize/scg.h"
#include "pleat/simd/dense.h"

namespace pleat {
namespace {

absl::Status CheckTraining(const Eigen::Ref<const Eigen::MatrixXd>& poses,
                           const DetailView& details, const std::vector<int>& clip_starts,
                           const SharedGplvmOptions& options) {
  if (poses.rows() < 2 || poses.cols() < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("a shared GPLVM needs at least two frames with at least one feature, got ",
                     poses.rows(), " x ", poses.cols()));
  }
  if (details.gram.rows() != poses.rows() || details.gram.cols() != poses.rows() ||
      !(details.num_outputs > 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("poses have ", poses.rows(), " frames, the Gram matrix of the details is ",
                     details.gram.rows(), " x ", details.gram.cols()));
  }
  if (!poses.allFinite() || !details.gram.allFinite()) {
    return absl::InvalidArgumentError("poses or details hold a value that is not finite");
  }
  if (options.latent_dimension < 1 || options.dynamics_order < 1 || options.dynamics_order > 2 ||
      !(options.dynamics_weight >= 0) || !(options.pose_weight > 0) ||
      !(options.detail_weight > 0) || options.max_iterations < 0) {
    return absl::InvalidArgumentError(
        "a shared GPLVM needs a latent dimension of at least 1, dynamics of order 1 or 2, a "
        "dynamics weight of at least 0, positive view weights and at least 0 iterations");
  }
  return CheckClipStarts(clip_starts, poses.rows());
}

// Returns the first q left singular vectors of the centered poses, times sqrt(N - 1); missing ones
// are zero.
Eigen::MatrixXd PcaStart(const Eigen::MatrixXd& poses, int q) {
  const PrincipalComponents pca = ComputePca(poses, {.max_components = q});
  Eigen::MatrixXd start = Eigen::MatrixXd::Zero(poses.rows(), q);
  for (Eigen::Index d = 0; d < pca.scores.cols(); ++d) {
    const double length = pca.scores.col(d).norm();
    if (length > 0) start.col(d) = pca.scores.col(d) * (std::sqrt(poses.rows() - 1.0) / length);
  }
  return start;
}

// Returns K_b on centered poses, and its log g.
Eigen::MatrixXd BackKernel(const Eigen::MatrixXd& poses, const SharedGplvmOptions& options,
                           double* log_inverse_width) {
  const Eigen::Index n = poses.rows();
  const DenseOps& ops = ChosenDenseOps();
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(n, n), kernel = distances;
  ops.squared_distances(poses.data(), n, poses.cols(), distances.data());
  const double median = MedianSquaredDistance(distances);
  *log_inverse_width = -std::log(median * options.back_width * options.back_width);
  ops.kernel(distances.data(), nullptr, n, std::exp(*log_inverse_width), 1, 0, 0, kernel.data());
  kernel.triangularView<Eigen::StrictlyUpper>() = kernel.transpose();
  return kernel;
}

absl::StatusOr<Eigen::VectorXd> Minimize(SharedGplvmObjective& objective,
                                         const Eigen::VectorXd& start,
                                         const SharedGplvmOptions& options,
                                         OptimizationSummary* summary, const Progress& progress) {
  if (options.optimizer == Optimizer::kScg) {
    // Kernels of back-constrained points are at the edge of double precision, where values round
    // too much for a second difference.
    const ScgCurvature curvature =
        options.back_constraints ? ScgCurvature::kGradients : ScgCurvature::kValues;
    return MinimizeScg(objective, start,
                       {.max_iterations = options.max_iterations, .curvature = curvature}, summary,
                       progress);
  }
  // The budget is as many evaluations as SCG would use, so that the two can be compared.
  return MinimizeLbfgs(
      objective, start,
      {.max_iterations = 2 * options.max_iterations, .max_evaluations = 2 * options.max_iterations},
      summary, progress);
}

}  // namespace

SharedGplvmOptions SharedGplvmOptions::Paper() {
  SharedGplvmOptions options;
  options.latent_dimension = 4;
  options.back_constraints = false;
  options.prior_precision = 0;
  options.relative_noise_floor = 0;
  options.absolute_jitter = 1e-8;
  return options;
}

DetailView MakeDetailView(const Eigen::Ref<const Eigen::MatrixXd>& outputs, ViewScaling scaling) {
  const Eigen::Index n = outputs.rows();
  Eigen::MatrixXd centered = outputs.rowwise() - outputs.colwise().mean();
  if (scaling == ViewScaling::kPerColumn) ScaleColumns(&centered);
  DetailView view;
  view.num_outputs = static_cast<double>(outputs.cols());
  view.gram.setZero(n, n);
  DenseSolver solver;
  const DenseView rows = ViewOf(centered);
  solver.MultiplyRows(rows, rows, centered.cols(),
                      {.c = view.gram.data(),
                       .ldc = n,
                       .m = n,
                       .n = n,
                       .part = DensePart::kLower,
                       .overwrite = true});
  view.gram.triangularView<Eigen::StrictlyUpper>() = view.gram.transpose();
  return view;
}

DetailView MakeDetailView(const PrincipalComponents& outputs, const std::vector<Eigen::Index>& rows,
                          ViewScaling scaling) {
  const Eigen::MatrixXd scores = outputs.scores(rows, Eigen::all);
  if (scaling == ViewScaling::kPerColumn) {
    return MakeDetailView(Eigen::MatrixXd(scores * outputs.basis.transpose()), scaling);
  }
  // Products are the same in any orthonormal basis.
  DetailView view = MakeDetailView(scores, scaling);
  view.num_outputs = static_cast<double>(outputs.basis.rows());
  const double kept = outputs.scores.squaredNorm() / static_cast<double>(outputs.scores.rows());
  if (outputs.kept_energy > 0) {
    view.gram.diagonal().array() += kept * (1 / outputs.kept_energy - 1);
  }
  return view;
}

absl::StatusOr<SharedGplvm> TrainSharedGplvm(const Eigen::Ref<const Eigen::MatrixXd>& poses,
                                             const DetailView& details,
                                             const std::vector<int>& clip_starts,
                                             const SharedGplvmOptions& options,
                                             SharedGplvmSummary* summary,
                                             const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckTraining(poses, details, clip_starts, options));
  const Eigen::Index n = poses.rows();
  SharedGplvmSummary local;
  SharedGplvmSummary& report = summary ? *summary : local;

  // Scale both views.
  const Eigen::MatrixXd centered = poses.rowwise() - poses.colwise().mean();
  Eigen::MatrixXd scaled = centered, gram = details.gram;
  if (options.scaling == ViewScaling::kPerColumn) {
    ScaleColumns(&scaled);
    report.pose_scale = report.detail_scale = 1;
  } else {
    report.pose_scale = PositiveRoot(scaled.squaredNorm() / double(scaled.size()));
    report.detail_scale = PositiveRoot(gram.trace() / (double(n) * details.num_outputs));
    scaled /= report.pose_scale;
    gram /= report.detail_scale * report.detail_scale;
  }
  PLEAT_ASSIGN_OR_RETURN(GramData pose_data, MakeGramData(scaled));
  PLEAT_ASSIGN_OR_RETURN(GramData detail_data, MakeGramDataFromGram(gram, details.num_outputs));

  SharedGplvm model;
  model.detail_scale = report.detail_scale;
  // The start knows nothing of the scaling of columns: the check values were made that way.
  const Eigen::MatrixXd start = PcaStart(centered, options.latent_dimension);
  Eigen::MatrixXd points = start, back_kernel;
  if (options.back_constraints) {
    back_kernel = BackKernel(centered, options, &model.back_log_inverse_width);
    Eigen::MatrixXd ridged = back_kernel, whitener, whitened;
    ridged.diagonal().array() += options.back_noise;
    DenseSolver solver;
    if (!solver.FactorAndInvert(ridged, whitener)) {
      return absl::InvalidArgumentError("the back-constraint kernel cannot be factored");
    }
    // The back weights that give the start, (K_b + back_noise I) A = X_0.
    solver.MultiplyByFactor(whitener, false, start, whitened);
    solver.MultiplyByFactor(whitener, true, whitened, points);
  }
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(n, n);
  ChosenDenseOps().squared_distances(start.data(), n, start.cols(), distances.data());
  const double prior_center = -std::log(MedianSquaredDistance(distances));

  SharedGplvmObjective objective(std::move(pose_data), std::move(detail_data), clip_starts,
                                 std::move(back_kernel), prior_center, options, progress);
  PLEAT_ASSIGN_OR_RETURN(const Eigen::VectorXd unknowns,
                         Minimize(objective, objective.Pack(points, {}, {}, {}), options,
                                  &report.optimization, progress));
  objective.Unpack(unknowns, &model);
  return model;
}

}  // namespace pleat
