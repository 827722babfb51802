#include "pleat/gp/inducing.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>

namespace pleat {
namespace {

constexpr double kJitter = 1e-7;  // share of the mean variance, on the diagonal of Kzz
constexpr Eigen::Index kBlockRows = 512;

// Returns the lower W with W^T W = L^-T (I - B^-1) L^-1, from L^-1 and gain = B - I, by
// eigenvectors and an orthogonal triangulation: the matrix itself is too near to singular to be
// factored.
Eigen::MatrixXf WhitenerOf(const Eigen::MatrixXd& inverse_factor, const Eigen::MatrixXd& gain) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gain);
  const Eigen::ArrayXd values = solver.eigenvalues().array().max(0);
  const Eigen::MatrixXd half = (values / (1 + values)).sqrt().matrix().asDiagonal() *
                               solver.eigenvectors().transpose() * inverse_factor;
  // half = Q R reversed, so that R becomes lower triangular.
  const Eigen::MatrixXd reversed = half.rowwise().reverse();
  const Eigen::MatrixXd r =
      Eigen::HouseholderQR<Eigen::MatrixXd>(reversed).matrixQR().triangularView<Eigen::Upper>();
  return r.reverse().cast<float>();
}

}  // namespace

Eigen::MatrixXd AdditiveCovariance(const std::vector<Eigen::MatrixXd>& a,
                                   const std::vector<Eigen::MatrixXd>& b,
                                   const std::vector<AdditiveTerm>& terms, double bias) {
  const Eigen::Index n = a.front().rows(), m = b.front().rows();
  DenseSolver solver;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(n, m, bias);
  Eigen::MatrixXd products, rbf;
  for (size_t e = 0; e < terms.size(); ++e) {
    products.resize(n, m);
    solver.MultiplyRows(ViewOf(a[e]), ViewOf(b[e]), a[e].cols(),
                        {.c = products.data(), .ldc = n, .m = n, .n = m, .overwrite = true});
    rbf = 2 * products;
    rbf.colwise() -= a[e].rowwise().squaredNorm();
    rbf.rowwise() -= b[e].rowwise().squaredNorm().transpose();
    rbf = (.5 * terms[e].inverse_width * rbf).cwiseMin(0);
    solver.ops().exp_in_place(rbf.data(), rbf.size());
    covariance += terms[e].amplitude * rbf + terms[e].linear * products;
  }
  return covariance;
}

bool SolveInduced(
    const Eigen::MatrixXd& covariance, double noise, const Eigen::MatrixXd& outputs,
    const std::function<Eigen::MatrixXd(Eigen::Index begin, Eigen::Index count)>& cross,
    const std::function<bool()>& cancelled, bool with_whitener, InducedWeights* weights) {
  const Eigen::Index m = covariance.rows(), num_outputs = outputs.cols();
  DenseSolver solver;
  Eigen::MatrixXd factor = covariance, w;  // L, L^-1
  factor.diagonal().array() += kJitter * covariance.trace() / static_cast<double>(m);
  if (!solver.FactorAndInvert(factor, w)) return false;

  // With the whitened rows G = Kxz L^-T both sums are of full precision: B - I = G^T G / s^2.
  // Forming Kzx Kxz first would square the condition number of Kzz and lose the digits that matter.
  Eigen::MatrixXd gain = Eigen::MatrixXd::Zero(m, m);             // G^T G, lower
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(m, num_outputs);  // G^T y
  Eigen::MatrixXd whitened;
  for (Eigen::Index begin = 0; begin < outputs.rows(); begin += kBlockRows) {
    if (cancelled()) return false;
    const Eigen::Index count = std::min(kBlockRows, outputs.rows() - begin);
    const Eigen::MatrixXd block = cross(begin, count);
    whitened.resize(count, m);
    solver.MultiplyRows(
        ViewOf(block), ViewOf(w, DenseShape::kLower), m,
        {.c = whitened.data(), .ldc = count, .m = count, .n = m, .overwrite = true});
    const DenseView columns = ViewOf(whitened).Transposed();
    solver.MultiplyRows(columns, columns, count,
                        {.c = gain.data(), .ldc = m, .m = m, .n = m, .part = DensePart::kLower});
    const DenseView targets{outputs.data() + begin, 1, outputs.outerStride()};
    solver.MultiplyRows(columns, targets.Transposed(), count,
                        {.c = right.data(), .ldc = m, .m = m, .n = num_outputs});
  }
  gain.triangularView<Eigen::StrictlyUpper>() = gain.transpose();
  gain /= noise;

  Eigen::MatrixXd b = gain, b_whitener;
  b.diagonal().array() += 1;
  if (cancelled() || !solver.FactorAndInvert(b, b_whitener)) return false;
  Eigen::MatrixXd x, y;
  solver.MultiplyByFactor(b_whitener, false, right, y);
  solver.MultiplyByFactor(b_whitener, true, y, x);
  solver.MultiplyByFactor(w, true, x, y);
  weights->alpha = y / noise;
  if (!with_whitener) return true;

  weights->whitener = WhitenerOf(w, gain);
  return true;
}

}  // namespace pleat
