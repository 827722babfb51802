// Pose fit and rig refinement of a generated performer of 10,000 vertices, on one core: what
// docs/performance.md quotes. The rig's joints are displaced, so that fits leave a residual as they
// do on captures.
#include <benchmark/benchmark.h>

#include "pleat/base/random.h"
#include "pleat/fitting/moments.h"
#include "pleat/fitting/pose_fit.h"
#include "pleat/fitting/rig_refinement.h"
#include "pleat/performer/performer.h"

namespace pleat {
namespace {

const Performer& BenchPerformer() {
  static const Performer performer =
      GeneratePerformer({.num_frames = 175, .num_vertices = 10000}).value();
  return performer;
}

const Rig& DisplacedRig() {
  static const Rig rig = [] {
    Rig displaced = BenchPerformer().truth.rig;
    Random random(1);
    Eigen::Matrix3Xd joints = displaced.skeleton.RestPositions();
    for (double& entry : joints.reshaped()) entry += 0.02 * random.Normal();
    displaced.skeleton = displaced.skeleton.WithRestPositions(joints);
    return displaced;
  }();
  return rig;
}

PoseTrack Fit(const Rig& rig, PoseFitSummary* summary) {
  return FitPoses(BenchPerformer().sequence, rig, {.bend_stiffness = 1e-4, .num_threads = 1},
                  summary)
      .value();
}

// frames/s is the figure: 1000 are a millisecond each.
void FitPerformer(benchmark::State& state) {
  DisplacedRig();  // made outside the loop
  PoseFitSummary summary;
  for (auto _ : state) benchmark::DoNotOptimize(Fit(DisplacedRig(), &summary));
  state.SetItemsProcessed(state.iterations() * BenchPerformer().sequence.num_frames());
  state.counters["linear_systems_per_frame"] = summary.mean_iterations;
  state.counters["rms_mm"] = 1000 * summary.rms_m;
}
BENCHMARK(FitPerformer)->Unit(benchmark::kMillisecond);

// The only part of a fit that grows with the vertices.
void FrameMomentsOfPerformer(benchmark::State& state) {
  const Rig& rig = DisplacedRig();
  const RigMoments moments = ComputeRigMoments(rig);
  for (auto _ : state) {
    benchmark::DoNotOptimize(ComputeFrameMoments(rig, moments, BenchPerformer().sequence.frame(9)));
  }
}
BENCHMARK(FrameMomentsOfPerformer)->Unit(benchmark::kMicrosecond);

void RefinePerformer(benchmark::State& state) {
  const PoseTrack track = Fit(DisplacedRig(), nullptr);
  RigRefinementOptions options;
  options.num_threads = 1;
  options.weights = options.rest = state.range(0) != 0;
  RigRefinementSummary summary;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        RefineRig(BenchPerformer().sequence, DisplacedRig(), track, options, &summary).value());
  }
  state.counters["rms_before_mm"] = 1000 * summary.round_rms_m.front();
  state.counters["rms_after_mm"] = 1000 * summary.rms_m;
}
BENCHMARK(RefinePerformer)->ArgName("full")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pleat
