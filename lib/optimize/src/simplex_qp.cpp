#include "pleat/optimize/simplex_qp.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cassert>

namespace pleat {
namespace {

// The entries that may be above zero, in ascending order. All others are held at zero.
struct PassiveSet {
  std::array<int, kMaxSimplexQpSize> entries;
  int size = 0;

  void Add(int entry) {
    int* const end = entries.data() + size++;
    int* const place = std::upper_bound(entries.data(), end, entry);
    std::move_backward(place, end, end + 1);
    *place = entry;
  }
};

// Finds the minimum over the passive entries with sum 1 and free signs, and returns the multiplier
// of the sum. At that minimum every passive entry has this gradient; an entry held at zero whose
// gradient is smaller would lower the objective if it were let go.
double SolvePassive(const SimplexQpMatrix& hessian, const SimplexQpVector& linear,
                    const PassiveSet& passive, SimplexQpVector* solution) {
  const int n = passive.size;
  SimplexQpMatrix matrix(n, n);
  SimplexQpVector right(n), ones = SimplexQpVector::Ones(n);
  for (int i = 0; i < n; ++i) {
    right[i] = linear[passive.entries[i]];
    for (int k = 0; k < n; ++k) matrix(i, k) = hessian(passive.entries[i], passive.entries[k]);
  }
  const Eigen::LLT<SimplexQpMatrix> factor(matrix);
  *solution = factor.solve(right);
  const SimplexQpVector along = factor.solve(ones);
  const double multiplier = (1 - solution->sum()) / along.sum();
  *solution += multiplier * along;
  return multiplier;
}

// Goes from the feasible `x` towards `target` until an entry meets zero, and drops that entry from
// the set. The way is straight and the objective convex, so it falls.
void StepToBoundary(const SimplexQpVector& target, PassiveSet* passive, SimplexQpVector* x) {
  double step = 1;
  for (int i = 0; i < passive->size; ++i) {
    const double from = (*x)[passive->entries[i]];
    if (target[i] <= 0) step = std::min(step, from / (from - target[i]));
  }
  PassiveSet kept;
  for (int i = 0; i < passive->size; ++i) {
    double& value = (*x)[passive->entries[i]];
    const bool bound = target[i] <= 0 && value <= step * (value - target[i]) * (1 + 1e-12);
    value = bound ? 0 : std::max(0.0, value + step * (target[i] - value));
    if (!bound) kept.Add(passive->entries[i]);
  }
  *passive = kept;
}

}  // namespace

void SolveSimplexQp(const SimplexQpMatrix& hessian, const SimplexQpVector& linear,
                    SimplexQpVector* x) {
  const int n = static_cast<int>(linear.size());
  assert(n >= 1 && hessian.rows() == n && hessian.cols() == n && x->size() == n);
  const double tolerance = 1e-12 * (hessian.diagonal().maxCoeff() + linear.cwiseAbs().maxCoeff());
  PassiveSet passive;
  for (int i = 0; i < n; ++i) {
    if ((*x)[i] > 0) passive.Add(i);
  }
  // Every turn either ends at a minimum over a new face of the simplex or drops an entry. The
  // objective falls each time, so no face comes twice; the bound only guards against rounding.
  for (int turn = 0; turn < 8 * n; ++turn) {
    SimplexQpVector target(passive.size);
    const double multiplier = SolvePassive(hessian, linear, passive, &target);
    if (!(target.minCoeff() > 0)) {
      StepToBoundary(target, &passive, x);
      continue;
    }
    x->setZero();
    for (int i = 0; i < passive.size; ++i) (*x)[passive.entries[i]] = target[i];
    *x /= x->sum();  // a nearly singular matrix leaves a trace
    const SimplexQpVector slope =
        (hessian * *x - linear - SimplexQpVector::Constant(n, multiplier)).eval();
    int best = -1;
    for (int i = 0; i < n; ++i) {
      if ((*x)[i] > 0 || slope[i] >= -tolerance) continue;
      if (best < 0 || slope[i] < slope[best]) best = i;
    }
    if (best < 0) return;
    passive.Add(best);
  }
}

void SolveSparseSimplexQp(const SimplexQpMatrix& hessian, const SimplexQpVector& linear,
                          int max_support, SimplexQpVector* x) {
  SolveSimplexQp(hessian, linear, x);
  PassiveSet support;
  for (int i = 0; i < x->size(); ++i) {
    if ((*x)[i] > 0) support.Add(i);
  }
  if (support.size <= max_support) return;
  std::stable_sort(support.entries.begin(), support.entries.begin() + support.size,
                   [x](int a, int b) { return (*x)[a] > (*x)[b]; });
  SimplexQpMatrix matrix(max_support, max_support);
  SimplexQpVector right(max_support), part(max_support);
  for (int i = 0; i < max_support; ++i) {
    right[i] = linear[support.entries[i]];
    part[i] = (*x)[support.entries[i]];
    for (int k = 0; k < max_support; ++k) {
      matrix(i, k) = hessian(support.entries[i], support.entries[k]);
    }
  }
  part /= part.sum();
  SolveSimplexQp(matrix, right, &part);
  x->setZero();
  for (int i = 0; i < max_support; ++i) (*x)[support.entries[i]] = part[i];
}

}  // namespace pleat
