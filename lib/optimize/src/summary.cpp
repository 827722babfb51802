#include "pleat/optimize/summary.h"

namespace pleat {

std::string StopReasonName(StopReason reason) {
  switch (reason) {
    case StopReason::kMaxIterations:
      return "maximum iterations";
    case StopReason::kGradientTolerance:
      return "gradient tolerance";
    case StopReason::kObjectiveTolerance:
      return "objective tolerance";
    case StopReason::kNoProgress:
      return "no progress";
  }
  return "unknown";
}

}  // namespace pleat
