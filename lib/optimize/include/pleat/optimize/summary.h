// What every optimizer reports about a run.
#pragma once

namespace pleat {

enum class StopReason {
  kMaxIterations,       // the budget of iterations or evaluations is used up
  kGradientTolerance,   // largest gradient entry small enough
  kObjectiveTolerance,  // the last accepted step hardly changed the objective
  kNoProgress,          // no descent is possible in double precision from here
};

struct OptimizationSummary {
  int iterations = 0;   // attempted steps (SCG) or line searches (L-BFGS)
  int evaluations = 0;  // evaluations of the value, alone or with the gradient
  double initial_objective = 0;
  double final_objective = 0;
  double final_gradient = 0;  // largest absolute entry
  StopReason stop_reason = StopReason::kMaxIterations;
};

}  // namespace pleat
