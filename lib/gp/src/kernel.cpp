#include "pleat/gp/kernel.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

// Keeps hyperparameters within exp(+-14), about 1e-6 to 1e6, where kernels neither vanish nor
// overflow.
double ClampedExp(double log_value) {
  return std::exp(std::clamp(log_value, -kMaxKernelLog, kMaxKernelLog));
}

}  // namespace

int NumKernelUnknowns(const KernelOptions& options) {
  return 3 + (options.bias ? 1 : 0) + (options.linear ? 1 : 0);
}

void PackKernelLogs(const KernelOptions& options, const KernelLogs& logs,
                    Eigen::Ref<Eigen::VectorXd> unknowns) {
  int i = 0;
  unknowns[i++] = logs.inverse_width;
  unknowns[i++] = logs.amplitude;
  if (options.bias) unknowns[i++] = logs.bias;
  unknowns[i++] = logs.noise;
  if (options.linear) unknowns[i++] = logs.linear;
}

KernelLogs UnpackKernelLogs(const KernelOptions& options,
                            const Eigen::Ref<const Eigen::VectorXd>& unknowns) {
  KernelLogs logs;
  int i = 0;
  logs.inverse_width = unknowns[i++];
  logs.amplitude = unknowns[i++];
  if (options.bias) logs.bias = unknowns[i++];
  logs.noise = unknowns[i++];
  if (options.linear) logs.linear = unknowns[i++];
  return logs;
}

KernelValues KernelValuesOf(const KernelOptions& options, const KernelLogs& logs) {
  return {ClampedExp(logs.inverse_width), ClampedExp(logs.amplitude),
          options.bias ? ClampedExp(logs.bias) : 0, ClampedExp(logs.noise),
          options.linear ? ClampedExp(logs.linear) : 0};
}

absl::Status CheckKernelLogs(const KernelOptions& options, const KernelLogs& logs,
                             const std::string& what) {
  const bool finite = std::isfinite(logs.inverse_width) && std::isfinite(logs.amplitude) &&
                      std::isfinite(logs.noise) && (!options.bias || std::isfinite(logs.bias)) &&
                      (!options.linear || std::isfinite(logs.linear));
  if (finite) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(what, ": a kernel hyperparameter is not finite"));
}

}  // namespace pleat
