// Small convex quadratic programs on the unit simplex, as they arise from blending weights and
// mixtures. An active-set method in the manner of Lawson and Hanson, "Solving Least Squares
// Problems" (1974), chapter 23, with the sum as an equality constraint.
#pragma once

#include <Eigen/Core>

namespace pleat {

// Matrices of this size and smaller live on the stack.
inline constexpr int kMaxSimplexQpSize = 16;
using SimplexQpMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxSimplexQpSize, kMaxSimplexQpSize>;
using SimplexQpVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxSimplexQpSize, 1>;

// Minimizes 1/2 x^T H x - c^T x over x >= 0, sum x = 1. hessian: H, n x n, symmetric positive
// definite, n <= kMaxSimplexQpSize; linear: c, n; `x`: n, a feasible start, overwritten. A start
// that already has the right entries above zero costs one linear system. It does not allocate, and
// the result is exact up to rounding.
void SolveSimplexQp(const SimplexQpMatrix& hessian, const SimplexQpVector& linear,
                    SimplexQpVector* x);

// Solves the same problem with at most `max_support` entries of x above zero: the largest ones of
// the solution without that limit, solved again among themselves. This is a heuristic, as the exact
// problem is combinatorial.
void SolveSparseSimplexQp(const SimplexQpMatrix& hessian, const SimplexQpVector& linear,
                          int max_support, SimplexQpVector* x);

}  // namespace pleat
