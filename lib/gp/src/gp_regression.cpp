#include "pleat/gp/gp_regression.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/simd/dense.h"
#include "pleat/simd/dense_ops.h"
#include "pleat/simd/weighted_rows.h"

namespace pleat {
namespace {

constexpr double kFarthest = 1e6;  // normalized units

// whitened = W k with W lower triangular, in blocks of rows: no temporary, and half of the work.
void Whiten(const Eigen::MatrixXf& whitener, const Eigen::VectorXf& kernel,
            Eigen::VectorXf* whitened) {
  constexpr Eigen::Index kBlock = 64;
  const Eigen::Index n = kernel.size();
  for (Eigen::Index i = 0; i < n; i += kBlock) {
    const Eigen::Index rows = std::min(kBlock, n - i);
    whitened->segment(i, rows).noalias() =
        whitener.block(i, 0, rows, i + rows) * kernel.head(i + rows);
  }
}

// sums (r x D) = rows^T slopes, for slopes (N x D). Several columns are summed together, so that
// the rows are read fewer times.
void SumRows(const Eigen::MatrixXd& slopes, const GpRegression::RowMajorMatrix& rows,
             Eigen::MatrixXd* sums) {
  sums->setZero(rows.cols(), slopes.cols());
  for (Eigen::Index d = 0; d < slopes.cols(); d += kMaxWeightedTogether) {
    const Eigen::Index count = std::min<Eigen::Index>(kMaxWeightedTogether, slopes.cols() - d);
    std::array<const double*, kMaxWeightedTogether> factors{};
    std::array<double*, kMaxWeightedTogether> columns{};
    for (Eigen::Index i = 0; i < count; ++i) {
      factors[i] = slopes.col(d + i).data();
      columns[i] = sums->col(d + i).data();
    }
    const auto num_together = static_cast<size_t>(count);
    AddWeightedRows({factors.data(), num_together}, rows.data(), rows.rows(), rows.cols(),
                    {columns.data(), num_together});
  }
}

absl::Status Refuse(const std::string& what) {
  return absl::InvalidArgumentError("GP regression parameters: " + what);
}

absl::Status CheckSizes(const GpRegressionParameters& p) {
  const Eigen::Index n = p.inputs.rows();
  if (n < 1 || p.inputs.cols() < 1 || p.alpha.cols() < 1) {
    return Refuse("no rows, no inputs or no outputs");
  }
  if (p.alpha.rows() != n) {
    return Refuse(absl::StrCat("alpha has ", p.alpha.rows(), " rows, the inputs ", n));
  }
  if (p.whitener.rows() != n || p.whitener.cols() != n) {
    return Refuse(absl::StrCat("whitener is ", p.whitener.rows(), " x ", p.whitener.cols(),
                               ", expected ", n, " x ", n));
  }
  if (p.input_mean.size() != p.inputs.cols() || p.input_scales.size() != p.inputs.cols()) {
    return Refuse(absl::StrCat("input mean and scales have ", p.input_mean.size(), " and ",
                               p.input_scales.size(), " entries, the inputs ", p.inputs.cols(),
                               " columns"));
  }
  if (p.output_mean.size() != p.alpha.cols()) {
    return Refuse(absl::StrCat("output mean has ", p.output_mean.size(), " entries, alpha ",
                               p.alpha.cols(), " columns"));
  }
  return absl::OkStatus();
}

absl::Status CheckValues(const GpRegressionParameters& p) {
  if (!p.inputs.allFinite()) return Refuse("an input is not finite");
  if (!p.alpha.allFinite()) return Refuse("an entry of alpha is not finite");
  if (!p.whitener.allFinite()) return Refuse("an entry of the whitener is not finite");
  if (!p.input_mean.allFinite() || !p.output_mean.allFinite())
    return Refuse("a mean is not finite");
  if (!p.input_scales.allFinite() || !(p.input_scales.minCoeff() > 0) ||
      !std::isfinite(p.output_scale) || !(p.output_scale > 0)) {
    return Refuse("a scale is not positive and finite");
  }
  if (!std::isfinite(p.kernel_options.relative_noise_floor) ||
      !std::isfinite(p.kernel_options.absolute_jitter) ||
      p.kernel_options.relative_noise_floor < 0 || p.kernel_options.absolute_jitter < 0) {
    return Refuse("a noise floor is negative or not finite");
  }
  return CheckKernelLogs(p.kernel_options, p.kernel, "GP regression parameters");
}

}  // namespace

GpRegression::GpRegression(GpRegressionParameters parameters)
    : parameters_(std::move(parameters)),
      values_(KernelValuesOf(parameters_.kernel_options, parameters_.kernel)),
      alpha_rows_(parameters_.alpha),
      squared_norms_(parameters_.inputs.rowwise().squaredNorm()) {
  prior_variance_ = (values_.a + values_.c * squared_norms_.mean()) * parameters_.output_scale *
                    parameters_.output_scale;
}

absl::StatusOr<GpRegression> GpRegression::FromParameters(GpRegressionParameters parameters) {
  if (absl::Status status = CheckSizes(parameters); !status.ok()) return status;
  if (absl::Status status = CheckValues(parameters); !status.ok()) return status;
  return GpRegression(std::move(parameters));
}

void GpRegression::Predict(const Eigen::Ref<const Eigen::VectorXd>& row, double input_variance,
                           Workspace* workspace, Eigen::Ref<Eigen::VectorXd> mean,
                           double* variance) const {
  const GpRegressionParameters& p = parameters_;
  Workspace& w = *workspace;
  assert(row.size() == p.inputs.cols() && mean.size() == p.alpha.cols());
  const Eigen::Index n = p.inputs.rows();
  w.row = (row - p.input_mean).cwiseQuotient(p.input_scales);
  // Beyond a million times the range of the training nothing changes but the risk of overflow. The
  // direction stays, so that a linear term still points the right way.
  if (const double largest = w.row.cwiseAbs().maxCoeff(); largest > kFarthest) {
    w.row *= kFarthest / largest;
  }
  w.products.setZero(n);
  AddWeightedRows(w.row.data(), p.inputs.data(), p.inputs.cols(), n, w.products.data());
  const double squared_norm = w.row.squaredNorm();
  // The squared distance as a difference of norms and products: one pass over the inputs serves the
  // RBF and the linear term. Rounding may make it negative, hence the minimum.
  w.rbf = (-.5 * values_.g * (squared_norms_.array() + squared_norm - 2 * w.products.array()))
              .min(0.0)
              .matrix();
  ChosenDenseOps().exp_in_place(w.rbf.data(), n);
  w.rbf *= values_.a;
  w.kernel = (w.rbf.array() + values_.b + values_.c * w.products.array()).matrix();
  mean.setZero();
  AddWeightedRows(w.kernel.data(), alpha_rows_.data(), n, p.alpha.cols(), mean.data());
  mean = p.output_mean + p.output_scale * mean;
  if (variance == nullptr) return;

  w.kernel_f = w.kernel.cast<float>();
  w.whitened.resize(n);
  Whiten(p.whitener, w.kernel_f, &w.whitened);
  double v = values_.a + values_.b + values_.c * squared_norm - double(w.whitened.squaredNorm());
  v = std::max(v, 0.0);
  if (input_variance > 0) {
    // dk_n/dx = -g (x - X_n) K0_n + c X_n.
    w.slopes.resize(n, p.inputs.cols());
    for (Eigen::Index d = 0; d < p.inputs.cols(); ++d) {
      const auto column = p.inputs.col(d).array();
      w.slopes.col(d) =
          (-values_.g * (w.row[d] - column) * w.rbf.array() + values_.c * column).matrix();
    }
    SumRows(w.slopes, alpha_rows_, &w.jacobian);
    w.jacobian.array().rowwise() /= p.input_scales.transpose().array();
    v += input_variance * w.jacobian.squaredNorm() / double(p.alpha.cols());
  }
  *variance = v * p.output_scale * p.output_scale;
}

}  // namespace pleat
