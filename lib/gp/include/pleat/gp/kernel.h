// The covariance function of every Gaussian process here, and its hyperparameters in log space
// (docs/method/learner.md#kernels).
//
//   k(x, x') = a exp(-g/2 |x - x'|^2) + b + c x.x' + (s^2 + floor) [x is x']
//
// RBF, bias and white noise are the paper's (section IV-B names the RBF, the public reference codes
// add the rest); the linear term is ours.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"

namespace pleat {

// Says which terms a kernel has beside the RBF and the noise, and what keeps it well conditioned.
struct KernelOptions {
  bool bias = true;
  bool linear = false;
  // The noise variance never falls below this share of the RBF amplitude (floor = share * a).
  double relative_noise_floor = 1e-6;
  // Added to the noise variance as it is; the check values of docs/method/learner.md#check-values
  // use 1e-8.
  double absolute_jitter = 0;
};

// Natural logarithms of the hyperparameters; terms that are off are ignored. Values outside
// +-kMaxKernelLog act as the nearest bound.
struct KernelLogs {
  double inverse_width = 0;  // log g, 1 / (input unit)^2
  double amplitude = 0;      // log a, (output unit)^2
  double bias = -2;          // log b, (output unit)^2
  double noise = -2;         // log s^2, (output unit)^2
  double linear = -4;        // log c, (output unit)^2 / (input unit)^2
};

inline constexpr double kMaxKernelLog = 14;

// The exponentials of the clamped logs.
struct KernelValues {
  double g, a, b, s2, c;  // b and c are zero when their term is off
};

// The logs as a vector of unknowns in the order log g, log a, [log b], log s^2, [log c].
int NumKernelUnknowns(const KernelOptions& options);
void PackKernelLogs(const KernelOptions& options, const KernelLogs& logs,
                    Eigen::Ref<Eigen::VectorXd> unknowns);
KernelLogs UnpackKernelLogs(const KernelOptions& options,
                            const Eigen::Ref<const Eigen::VectorXd>& unknowns);

KernelValues KernelValuesOf(const KernelOptions& options, const KernelLogs& logs);

// Returns kInvalidArgument naming `what` when an active log is not finite.
absl::Status CheckKernelLogs(const KernelOptions& options, const KernelLogs& logs,
                             const std::string& what);

}  // namespace pleat
