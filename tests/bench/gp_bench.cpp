// Training and query times of the learner on generated data of a captured clip's shape:
// D_S = 102 features, D_M = 1050 details (docs/method/learner.md#check-values).
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "pleat/base/random.h"
#include "pleat/gp/shared_gplvm.h"
#include "pleat/learner/detail_model.h"

namespace pleat {
namespace {

constexpr int kNumFeatures = 102, kNumDetails = 1050;

struct Data {
  Eigen::MatrixXd features, details;  // N x 102, N x 1050
};

// Smooth mixtures of harmonics of a slowly changing phase, a little noise on the details.
Data MakeData(int num_frames) {
  Random random(1);
  constexpr int kNumHarmonics = 12;
  Eigen::MatrixXd feature_mix(kNumHarmonics, kNumFeatures), detail_mix(kNumHarmonics, kNumDetails);
  for (double& x : feature_mix.reshaped()) x = random.Normal();
  for (double& x : detail_mix.reshaped()) x = random.Normal();
  Data data{Eigen::MatrixXd(num_frames, kNumFeatures), Eigen::MatrixXd(num_frames, kNumDetails)};
  for (int t = 0; t < num_frames; ++t) {
    Eigen::RowVectorXd state(kNumHarmonics);
    for (int h = 0; h < kNumHarmonics; ++h) {
      state[h] = std::sin((h + 1) * .05 * t + .3 * std::sin(.013 * t) * h) / (h + 1);
    }
    data.features.row(t) = .3 * state * feature_mix;
    data.details.row(t) = state.cwiseAbs2() * detail_mix;
  }
  for (double& x : data.details.reshaped()) x += .02 * random.Normal();
  return data;
}

// The paper's learner: 100 iterations of SCG, q = 4.
void BM_TrainSharedGplvmPaper(benchmark::State& state) {
  const Data data = MakeData(static_cast<int>(state.range(0)));
  const SharedGplvmOptions options = SharedGplvmOptions::Paper();
  const DetailView details = MakeDetailView(data.details, options.scaling);
  SharedGplvmSummary summary;
  for (auto _ : state) {
    benchmark::DoNotOptimize(TrainSharedGplvm(data.features, details, {0}, options, &summary));
  }
  state.counters["evaluations"] = summary.optimization.evaluations;
}
BENCHMARK(BM_TrainSharedGplvmPaper)->Arg(100)->Arg(200)->Arg(400)->Unit(benchmark::kMillisecond);

// The shape of a default training: q = 13, N of a clip and of the most rows it learns from.
void BM_TrainSharedGplvm13(benchmark::State& state) {
  const Data data = MakeData(static_cast<int>(state.range(0)));
  SharedGplvmOptions options = SharedGplvmOptions::Paper();
  options.latent_dimension = 13;
  const DetailView details = MakeDetailView(data.details, options.scaling);
  for (auto _ : state) {
    benchmark::DoNotOptimize(TrainSharedGplvm(data.features, details, {0}, options));
  }
}
BENCHMARK(BM_TrainSharedGplvm13)->Arg(175)->Arg(600)->Unit(benchmark::kMillisecond);

// The same learner by L-BFGS with half of the evaluations. "below_scg": by how much its objective
// is lower, relative to the descent from the start.
void BM_TrainSharedGplvmLbfgs(benchmark::State& state) {
  const Data data = MakeData(static_cast<int>(state.range(0)));
  SharedGplvmOptions options = SharedGplvmOptions::Paper();
  const DetailView details = MakeDetailView(data.details, options.scaling);
  SharedGplvmSummary scg, lbfgs;
  benchmark::DoNotOptimize(TrainSharedGplvm(data.features, details, {0}, options, &scg));
  options.optimizer = Optimizer::kLbfgs;
  options.max_iterations /= 2;
  for (auto _ : state) {
    benchmark::DoNotOptimize(TrainSharedGplvm(data.features, details, {0}, options, &lbfgs));
  }
  state.counters["evaluations"] = lbfgs.optimization.evaluations;
  state.counters["below_scg"] =
      (scg.optimization.final_objective - lbfgs.optimization.final_objective) /
      (scg.optimization.initial_objective - scg.optimization.final_objective);
}
BENCHMARK(BM_TrainSharedGplvmLbfgs)->Arg(100)->Arg(200)->Arg(400)->Unit(benchmark::kMillisecond);

void BM_TrainDirectGp(benchmark::State& state) {
  const Data data = MakeData(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(TrainDetailModel(data.features, data.details, {0}));
  }
}
BENCHMARK(BM_TrainDirectGp)->Arg(100)->Arg(200)->Arg(400)->Unit(benchmark::kMillisecond);

// One query: coefficients and confidence, without the expansion to vertices.
void Query(benchmark::State& state, Learner learner) {
  const Data data = MakeData(static_cast<int>(state.range(0)));
  DetailModelOptions options;
  options.learner = learner;
  options.sgplvm.max_iterations = options.gp.max_iterations = 5;
  const auto model = TrainDetailModel(data.features, data.details, {0}, options);
  if (!model.ok()) {
    state.SkipWithError(std::string(model.status().message()).c_str());
    return;
  }
  DetailModel::Workspace workspace;
  Eigen::VectorXf coefficients(model->num_components());
  const Eigen::VectorXd row = data.features.row(7).transpose();
  for (auto _ : state) {
    benchmark::DoNotOptimize(model->PredictCoefficients(row, &workspace, coefficients));
  }
}
void BM_QueryDirectGp(benchmark::State& state) { Query(state, Learner::kGp); }
void BM_QuerySharedGplvm(benchmark::State& state) { Query(state, Learner::kSgplvm); }
BENCHMARK(BM_QueryDirectGp)->Arg(200)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_QuerySharedGplvm)->Arg(200)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pleat
