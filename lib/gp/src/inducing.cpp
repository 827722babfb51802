#include "inducing.h"

#include <algorithm>

namespace pleat {
namespace {

constexpr double kJitter = 1e-7;  // share of the mean variance, on the diagonal of Kzz
constexpr Eigen::Index kBlockRows = 512;

// The lower triangle mirrored.
void MakeSymmetric(Eigen::MatrixXd* m) {
  m->triangularView<Eigen::StrictlyUpper>() = m->transpose();
}

// Lower W with W^T W = `v` (symmetric, nearly singular): the Cholesky factor from the last row up.
bool FactorFromBelow(const Eigen::MatrixXd& v, DenseSolver* solver, Eigen::MatrixXf* whitener) {
  Eigen::MatrixXd reversed = v.reverse(), unused;
  reversed.diagonal().array() += 1e-10 * v.trace() / static_cast<double>(v.rows());
  if (!solver->FactorAndInvert(reversed, unused)) return false;
  const Eigen::MatrixXd lower = reversed.triangularView<Eigen::Lower>();
  *whitener = lower.reverse().transpose().cast<float>();
  return true;
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
    products.setZero(n, m);
    solver.MultiplyAdd(1, ViewOf(a[e]), ViewOf(b[e]).Transposed(), products.data(), n, n, m,
                       a[e].cols());
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
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(m, m);             // Kzx Kxz, lower
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(m, num_outputs);  // Kzx y
  for (Eigen::Index begin = 0; begin < outputs.rows(); begin += kBlockRows) {
    if (cancelled()) return false;
    const Eigen::Index count = std::min(kBlockRows, outputs.rows() - begin);
    const Eigen::MatrixXd block = cross(begin, count);
    const DenseView rows = ViewOf(block);
    solver.MultiplyAdd(1, rows.Transposed(), rows, gram.data(), m, m, m, count, true);
    const DenseView targets{outputs.data() + begin, 1, outputs.outerStride()};
    solver.MultiplyAdd(1, rows.Transposed(), targets, right.data(), m, m, num_outputs, count);
  }
  MakeSymmetric(&gram);

  Eigen::MatrixXd factor = covariance, w;  // L, L^-1
  factor.diagonal().array() += kJitter * covariance.trace() / static_cast<double>(m);
  if (!solver.FactorAndInvert(factor, w)) return false;
  Eigen::MatrixXd half, b;
  solver.MultiplyByFactor(w, false, gram, false, half);
  solver.MultiplyByFactor(w, false, Eigen::MatrixXd(half.transpose()), false, b);
  b = .5 / noise * (b + Eigen::MatrixXd(b.transpose()));
  b.diagonal().array() += 1;
  Eigen::MatrixXd b_whitener;
  if (cancelled() || !solver.FactorAndInvert(b, b_whitener)) return false;

  Eigen::MatrixXd x, y;
  solver.MultiplyByFactor(w, false, right, false, x);
  solver.MultiplyByFactor(b_whitener, false, x, false, y);
  solver.MultiplyByFactor(b_whitener, true, y, false, x);
  solver.MultiplyByFactor(w, true, x, false, y);
  weights->alpha = y / noise;
  if (!with_whitener) return true;

  Eigen::MatrixXd known = Eigen::MatrixXd::Zero(m, m);  // I - B^-1
  solver.InverseFromFactor(b_whitener, known);
  MakeSymmetric(&known);
  known = Eigen::MatrixXd::Identity(m, m) - known;
  solver.MultiplyByFactor(w, true, known, false, half);
  solver.MultiplyByFactor(w, true, Eigen::MatrixXd(half.transpose()), false, known);
  return FactorFromBelow(.5 * (known + Eigen::MatrixXd(known.transpose())), &solver,
                         &weights->whitener);
}

}  // namespace pleat
