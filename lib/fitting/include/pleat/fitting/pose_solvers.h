// Solvers for the pose of one frame, all from moments (docs/method/fit.md#solvers).
#pragma once

#include "pleat/fitting/moments.h"
#include "pleat/fitting/pose_energy.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Returns a start that needs no previous frame, in closed form: the root from a rigid fit of the
// bones at the hips, then from the root to the leaves each bone's rotation about its fixed pivot,
// by a weighted Procrustes fit of the bone's own vertices (docs/method/fit.md#closed-form-start).
ChainPose ClosedFormWalk(const RigMoments& moments, const FrameMoments& frame,
                         const Skeleton& skeleton);

// Makes one sweep of the paper's fit (section III-B): from the root to the leaves, each joint turns
// its whole subtree by the rotation that minimizes the energy of all vertices with the other joints
// held, in closed form. It never raises the energy. Costs O(J^3) small products.
void WalkSweep(const PoseEnergy& energy, const Skeleton& skeleton, ChainPose* pose);

struct PoseSolverOptions {
  // Typical frames need 5-15; 60 lets a bad start crawl out of a flat valley.
  int max_iterations = 60;
  // Stop when an accepted step lowers the energy by less than this share of itself.
  double tolerance = 1e-5;
};

struct PoseSolverSummary {
  int num_iterations = 0;  // linear systems solved
  bool converged = false;  // false: stopped by max_iterations
  double energy = 0;       // at the end, square meters, stiffness included
};

// Minimizes the energy by Levenberg-Marquardt on all rotations and the root position together
// (Marquardt 1963, damping scaled by the diagonal). Starts from `pose` and overwrites it; never
// raises the energy. See docs/method/fit.md#all-joints.
PoseSolverSummary MinimizePose(const PoseEnergy& energy, const PoseSolverOptions& options,
                               ChainPose* pose);

}  // namespace pleat
