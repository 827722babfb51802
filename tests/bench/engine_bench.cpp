// The C interface against the C++ evaluator, in one run: what it adds to a query
// (docs/performance.md).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "pleat.h"
#include "pleat/character/fit_motion.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/formats/model_file.h"
#include "pleat/performer/performer.h"

namespace pleat {
namespace {

constexpr int kNumVertices = 10000, kNumFrames = 60, kBatch = 16;

struct Setup {
  std::shared_ptr<const CharacterModel> character;
  PoseTrack track;
  pleat_model* model = nullptr;
  std::vector<std::vector<double>> rotations;
  std::vector<pleat_pose> poses;  // of the frames, backwards, so that history follows the pose
};

const Setup& TheSetup() {
  static const Setup* const setup = [] {
    auto* made = new Setup;
    const Performer performer =
        GeneratePerformer({.num_frames = kNumFrames, .num_vertices = kNumVertices}).value();
    made->character = TrainCharacter({performer.sequence}, {}).value();
    made->track = FitMotion(*made->character, performer.sequence).value();
    const std::string bytes = EncodeModel(*made->character);
    pleat_model_create(bytes.data(), bytes.size(), nullptr, &made->model, nullptr);
    for (int t = kNumFrames - 1; t >= 0; --t) {
      made->rotations.emplace_back();
      for (const Eigen::Quaterniond& q : made->track.pose(t).rotations) {
        made->rotations.back().insert(made->rotations.back().end(), q.coeffs().begin(),
                                      q.coeffs().end());
      }
      pleat_pose pose{.root_position = {},
                      .rotations = made->rotations.back().data(),
                      .num_joints = made->track.pose(t).rotations.size()};
      Eigen::Map<Eigen::Vector3d>(pose.root_position) = made->track.pose(t).root_position;
      made->poses.push_back(pose);
    }
    return made;
  }();
  return *setup;
}

// A batch of our evaluator and the same batch through the C interface, by turns.
class Batches {
 public:
  Batches() : evaluator_(TheSetup().character), frames_(kBatch), poses_(kBatch), queries_(kBatch) {
    pleat_evaluator_create(TheSetup().model, &c_evaluator_, nullptr);
    const int num_vertices = TheSetup().character->num_vertices();
    positions_.assign(kBatch, std::vector<float>(3 * static_cast<size_t>(num_vertices)));
    c_queries_.resize(kBatch);
    for (int q = 0; q < kBatch; ++q) {
      pleat_query& query = c_queries_[q];
      query = {};
      query.struct_size = sizeof(query);
      query.num_poses = 2;
      query.positions = {positions_[q].data(), 0, positions_[q].size() * sizeof(float)};
    }
  }
  ~Batches() { pleat_evaluator_destroy(c_evaluator_); }

  bool RunOurs(int first) {
    const PoseTrack& track = TheSetup().track;
    for (int q = 0; q < kBatch; ++q) {
      poses_[q] = {&track.pose(first + q + 1), &track.pose(first + q)};
      queries_[q] = {.poses = &poses_[q], .frame = &frames_[q]};
    }
    evaluator_.EvaluateBatch(queries_);
    return queries_.back().status.ok();
  }
  bool RunC(int first) {
    for (int q = 0; q < kBatch; ++q) {
      c_queries_[q].poses = &TheSetup().poses[kNumFrames - 1 - (first + q + 1)];
    }
    return pleat_evaluate(c_evaluator_, c_queries_.data(), kBatch, nullptr) == PLEAT_OK;
  }
  bool AreEqual() const {
    for (int q = 0; q < kBatch; ++q) {
      if (!std::equal(positions_[q].begin(), positions_[q].end(), frames_[q].positions.data())) {
        return false;
      }
    }
    return true;
  }

 private:
  PoseEvaluator evaluator_;
  std::vector<EvaluatedFrame> frames_;
  std::vector<std::vector<const Pose*>> poses_;
  std::vector<PoseQuery> queries_;
  pleat_evaluator* c_evaluator_ = nullptr;
  std::vector<std::vector<float>> positions_;
  std::vector<pleat_query> c_queries_;
};

// The time is that of both batches; `ratio` is the median over pairs of C by C++, so that what else
// the machine does meets both.
void CBatchByOurs(benchmark::State& state) {
  using Clock = std::chrono::steady_clock;
  Batches batches;
  std::vector<double> ratios;
  int first = 0;
  for (auto _ : state) {
    const auto begin = Clock::now();
    const bool ours = batches.RunOurs(first);
    const auto middle = Clock::now();
    const bool c = batches.RunC(first);
    const auto end = Clock::now();
    if (!ours || !c || !batches.AreEqual()) state.SkipWithError("the frames differ");
    ratios.push_back((end - middle) / std::chrono::duration<double>(middle - begin));
    first = (first + kBatch) % (kNumFrames - kBatch - 1);
  }
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  state.counters["ratio"] = ratios[ratios.size() / 2];
}
BENCHMARK(CBatchByOurs)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pleat
