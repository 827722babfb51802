// Gaussian processes of many rows through few inducing rows: the cost grows linearly with the rows
// (docs/method/learner.md#inducing-rows).
//
// With inducing rows Z, Kzz + jitter = L L^T and B = I + L^-1 Kzx Kxz L^-T / s^2, the posterior
// mean is k_z(x)^T alpha with alpha = L^-T B^-1 L^-1 Kzx y / s^2, and the variance is k(x, x) -
// k_z(x)^T L^-T (I - B^-1) L^-1 k_z(x). Source: M. Titsias, "Variational learning of inducing
// variables in sparse Gaussian processes", AISTATS 2009; J. Quinonero-Candela, C. E. Rasmussen, "A
// unifying view of sparse approximate Gaussian process regression", JMLR 6 (2005).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "pleat/simd/dense.h"

namespace pleat {

// One term of an additive kernel: a exp(-g/2 |x - x'|^2) + c x.x' over its own inputs.
struct AdditiveTerm {
  double inverse_width = 1, amplitude = 1, linear = 0;  // g, a, c
};

// Returns the covariances (N x M) of the rows of `a` and `b`: term e sees a[e] (N x D_e) and b[e]
// (M x D_e).
Eigen::MatrixXd AdditiveCovariance(const std::vector<Eigen::MatrixXd>& a,
                                   const std::vector<Eigen::MatrixXd>& b,
                                   const std::vector<AdditiveTerm>& terms, double bias);

struct InducedWeights {
  Eigen::MatrixXd alpha;     // M x r
  Eigen::MatrixXf whitener;  // M x M, lower: variance = k(x, x) - |W k_z(x)|^2; empty if not wanted
};

// Solves for the weights. The rows come block by block, [begin, begin + count): `cross` gives Kxz
// (count x M) and `outputs` (N x r) is what is learned. covariance: M x M, Kzz without noise;
// noise: s^2. Returns false when a matrix cannot be factored or `cancelled` says so. Memory is
// O(M^2 + M r) beside the outputs, whatever N is.
bool SolveInduced(
    const Eigen::MatrixXd& covariance, double noise, const Eigen::MatrixXd& outputs,
    const std::function<Eigen::MatrixXd(Eigen::Index begin, Eigen::Index count)>& cross,
    const std::function<bool()>& cancelled, bool with_whitener, InducedWeights* weights);

}  // namespace pleat
