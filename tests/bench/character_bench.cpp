// Training and one query of a generated performer: what docs/performance.md quotes.
#include <benchmark/benchmark.h>

#include "pleat/character/fit_motion.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/performer/performer.h"

namespace pleat {
namespace {

constexpr int kNumFrames = 175;  // as the captured sequences
constexpr int kNumVertices = 10000;

const Performer& BenchPerformer() {
  static const Performer performer = [] {
    PerformerOptions options;
    options.num_frames = kNumFrames;
    options.num_vertices = kNumVertices;
    return GeneratePerformer(options).value();
  }();
  return performer;
}

TrainOptions Learner(const std::string& learner) {
  TrainOptions options;
  options.learner = ParseChoice<LearnerChoice>("learner", learner).value();
  return options;
}

std::shared_ptr<const CharacterModel> BenchCharacter(const std::string& learner) {
  return TrainCharacter({BenchPerformer().sequence}, Learner(learner)).value();
}

void TrainPerformer(benchmark::State& state, const std::string& learner) {
  BenchPerformer();
  for (auto _ : state) benchmark::DoNotOptimize(BenchCharacter(learner));
}
BENCHMARK_CAPTURE(TrainPerformer, gp, "gp")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(TrainPerformer, sgplvm, "sgplvm")->Unit(benchmark::kMillisecond)->UseRealTime();

// Pose with one predecessor -> full mesh of 10,000 vertices.
void EvaluatePose(benchmark::State& state, const std::string& learner) {
  const std::shared_ptr<const CharacterModel> model = BenchCharacter(learner);
  const PoseTrack track = FitMotion(*model, BenchPerformer().sequence).value();
  PoseEvaluator evaluator(model);
  EvaluatedFrame frame;
  int t = 1;
  for (auto _ : state) {
    const absl::Status status =
        evaluator.Evaluate({&track.pose(t), &track.pose(t - 1)}, {}, &frame);
    if (!status.ok()) state.SkipWithError(status.ToString().c_str());
    t = t + 1 < track.num_frames() ? t + 1 : 1;
  }
  state.counters["components"] = model->full_basis().num_coefficients();
  state.counters["model_MB"] = static_cast<double>(model->memory_bytes()) / 1e6;
}
BENCHMARK_CAPTURE(EvaluatePose, gp, "gp")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(EvaluatePose, sgplvm, "sgplvm")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(EvaluatePose, regional, "regional")->Unit(benchmark::kMicrosecond);

// The same after something else has used the caches, as in a live session between two frames.
void EvaluateColdPose(benchmark::State& state, const std::string& learner) {
  constexpr size_t kOthersBytes = 64 << 20, kCacheLineBytes = 64;
  const std::shared_ptr<const CharacterModel> model = BenchCharacter(learner);
  const PoseTrack track = FitMotion(*model, BenchPerformer().sequence).value();
  PoseEvaluator evaluator(model);
  EvaluatedFrame frame;
  std::vector<char> others(kOthersBytes);
  int t = 1;
  for (auto _ : state) {
    state.PauseTiming();
    for (size_t i = 0; i < kOthersBytes; i += kCacheLineBytes) ++others[i];
    benchmark::DoNotOptimize(others.data());
    state.ResumeTiming();
    const absl::Status status =
        evaluator.Evaluate({&track.pose(t), &track.pose(t - 1)}, {}, &frame);
    if (!status.ok()) state.SkipWithError(status.ToString().c_str());
    t = t + 1 < track.num_frames() ? t + 1 : 1;
  }
}
BENCHMARK_CAPTURE(EvaluateColdPose, gp, "gp")->Unit(benchmark::kMicrosecond)->Iterations(300);
BENCHMARK_CAPTURE(EvaluateColdPose, regional, "regional")
    ->Unit(benchmark::kMicrosecond)
    ->Iterations(300);

// Sixteen queries together; the time is that of one.
void EvaluateBatch(benchmark::State& state, const std::string& learner) {
  constexpr int kBatch = 16;
  const std::shared_ptr<const CharacterModel> model = BenchCharacter(learner);
  const PoseTrack track = FitMotion(*model, BenchPerformer().sequence).value();
  PoseEvaluator evaluator(model);
  std::vector<EvaluatedFrame> frames(kBatch);
  std::vector<std::vector<const Pose*>> poses(kBatch);
  std::vector<PoseQuery> queries(kBatch);
  int t = 1;
  while (state.KeepRunningBatch(kBatch)) {
    for (int q = 0; q < kBatch; ++q) {
      poses[q] = {&track.pose(t), &track.pose(t - 1)};
      queries[q].poses = &poses[q];
      queries[q].frame = &frames[q];
      t = t + 1 < track.num_frames() ? t + 1 : 1;
    }
    evaluator.EvaluateBatch(queries);
    if (!queries.back().status.ok()) state.SkipWithError("a query failed");
  }
}
BENCHMARK_CAPTURE(EvaluateBatch, gp, "gp")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(EvaluateBatch, regional, "regional")->Unit(benchmark::kMicrosecond);

void SkinPose(benchmark::State& state) {
  const std::shared_ptr<const CharacterModel> model = BenchCharacter("gp");
  PoseEvaluator evaluator(model);
  EvaluatedFrame frame;
  const Pose pose = Pose::Rest(model->skeleton());
  for (auto _ : state) {
    const absl::Status status = evaluator.EvaluateSkinned(pose, {}, &frame);
    if (!status.ok()) state.SkipWithError(status.ToString().c_str());
  }
}
BENCHMARK(SkinPose)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pleat
