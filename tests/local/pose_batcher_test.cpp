#include "pleat/local/pose_batcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <future>
#include <memory>
#include <thread>

#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

std::shared_ptr<const CharacterModel> FakeModel(uint64_t seed = 1) {
  TrainOptions options;
  options.seed = seed;
  return MakeFakeModel(MakeSwayingTube(5), options);
}

// Shows one pose, and notes in which order frames were done.
class Show final : public PoseWork {
 public:
  Show(std::shared_ptr<const CharacterModel> model, Pose pose, std::vector<Show*>* order)
      : evaluator_(std::move(model)), pose_(std::move(pose)), poses_{&pose_}, order_(order) {}

  bool Prepare(PoseQuery* query) override {
    query->poses = &poses_;
    query->frame = &frame;
    return !withdrawn;
  }
  PoseEvaluator& evaluator() override { return evaluator_; }
  void Evaluated(const PoseQuery* query, double, int together) override {
    finished = true;
    num_together = together;
    if (query != nullptr) status = query->status;
    if (order_ != nullptr) order_->push_back(this);
    if (then) then();
  }
  const Pose& pose() const { return pose_; }

  bool withdrawn = false, finished = false;
  int num_together = -1;
  absl::Status status;
  EvaluatedFrame frame;
  std::function<void()> then;  // after it was evaluated

 private:
  PoseEvaluator evaluator_;
  const Pose pose_;
  const std::vector<const Pose*> poses_;
  std::vector<Show*>* order_;
};

// Keeps the thread of an executor busy until it is released.
class Hold {
 public:
  explicit Hold(Executor* executor) {
    executor->Post([released = released_.get_future().share()] { released.wait(); });
  }
  void Release() { released_.set_value(); }

 private:
  std::promise<void> released_;
};

class PoseBatcherTest : public testing::Test {
 protected:
  std::unique_ptr<Show> MakeShow(std::shared_ptr<const CharacterModel> model, int t) {
    const PoseTrack track = MakeMotion(model->skeleton(), t + 1);
    return std::make_unique<Show>(std::move(model), track.pose(t), &order_);
  }
  std::vector<Show*> order_;  // of one thread
};

TEST_F(PoseBatcherTest, WhatWaitsForOneModelIsEvaluatedTogetherToTheSameFrames) {
  const auto model = FakeModel();
  std::vector<std::unique_ptr<Show>> shows;
  {
    auto executor = std::make_unique<Executor>(1);
    PoseBatcher batcher(executor.get(), 4);
    Hold hold(executor.get());
    for (int t = 0; t < 10; ++t) {
      shows.push_back(MakeShow(model, t));
      batcher.Submit(model.get(), shows.back().get());
    }
    hold.Release();
    executor.reset();  // waits for all work, which uses the batcher
  }
  PoseEvaluator evaluator(model);
  for (int t = 0; t < 10; ++t) {
    EXPECT_EQ(shows[t]->num_together, t < 8 ? 4 : 2);
    EXPECT_EQ(order_[t], shows[t].get());
    EvaluatedFrame frame;
    ASSERT_THAT(evaluator.Evaluate({&shows[t]->pose()}, {}, &frame), IsOk());
    EXPECT_EQ(shows[t]->frame.positions, frame.positions);
    EXPECT_EQ(shows[t]->frame.confidence, frame.confidence);
  }
}

TEST_F(PoseBatcherTest, ModelsAreNotMixedAndAManyTimesUsedOneStarvesNoOther) {
  const auto popular = FakeModel(1), rare = FakeModel(2);
  std::vector<std::unique_ptr<Show>> shows;
  const auto last = MakeShow(rare, 3);
  {
    auto executor = std::make_unique<Executor>(1);
    PoseBatcher batcher(executor.get(), 4);
    Hold hold(executor.get());
    for (int t = 0; t < 40; ++t) {
      shows.push_back(MakeShow(popular, t % 5));
      batcher.Submit(popular.get(), shows.back().get());
      if (t == 0) batcher.Submit(rare.get(), last.get());
    }
    hold.Release();
    executor.reset();  // waits for all work, which uses the batcher
  }
  EXPECT_EQ(last->num_together, 1);
  EXPECT_EQ(order_[4], last.get()) << "it came second and waits for one batch";
  EvaluatedFrame frame;
  ASSERT_THAT(PoseEvaluator(rare).Evaluate({&last->pose()}, {}, &frame), IsOk());
  EXPECT_EQ(last->frame.positions, frame.positions);
}

// Sessions whose poses never run out. Every batch answers four of them and takes one turn: were
// there a turn for every answer, the other model would wait longer the later it came.
TEST_F(PoseBatcherTest, WorkThatComesBackAtOnceDoesNotPileUpTurns) {
  constexpr size_t kNumShows = 8, kTogether = 4, kArrival = 200, kEnd = 1000;
  const auto popular = FakeModel(1), rare = FakeModel(2);
  std::vector<std::unique_ptr<Show>> shows;
  const auto late = MakeShow(rare, 3);
  {
    auto executor = std::make_unique<Executor>(1);
    PoseBatcher batcher(executor.get(), kTogether);
    Hold hold(executor.get());
    for (size_t i = 0; i < kNumShows; ++i) {
      shows.push_back(MakeShow(popular, static_cast<int>(i % 5)));
      shows.back()->then = [&, show = shows.back().get()] {
        if (order_.size() == kArrival) batcher.Submit(rare.get(), late.get());
        if (order_.size() < kEnd) batcher.Submit(popular.get(), show);
      };
      batcher.Submit(popular.get(), shows.back().get());
    }
    hold.Release();
    executor.reset();  // waits for all work, which uses the batcher
  }
  const auto place = std::find(order_.begin(), order_.end(), late.get()) - order_.begin();
  EXPECT_LE(static_cast<size_t>(place), kArrival + (kNumShows + 1) * kTogether);
}

TEST_F(PoseBatcherTest, WorkThatIsWithdrawnOrWrongDisturbsNobody) {
  const auto model = FakeModel();
  const auto good = MakeShow(model, 1), withdrawn = MakeShow(model, 2);
  withdrawn->withdrawn = true;
  Pose short_pose = Pose::Rest(model->skeleton());
  short_pose.rotations.pop_back();
  Show wrong(model, short_pose, &order_);
  {
    auto executor = std::make_unique<Executor>(1);
    PoseBatcher batcher(executor.get(), 16);
    Hold hold(executor.get());
    batcher.Submit(model.get(), withdrawn.get());
    batcher.Submit(model.get(), &wrong);
    batcher.Submit(model.get(), good.get());
    hold.Release();
    executor.reset();  // waits for all work, which uses the batcher
  }
  EXPECT_TRUE(withdrawn->finished);
  EXPECT_THAT(wrong.status, HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
  EXPECT_THAT(good->status, IsOk());
  EXPECT_EQ(good->num_together, 2);
}

TEST_F(PoseBatcherTest, ManyThreadsShareTheWork) {
  const auto model = FakeModel();
  std::vector<std::unique_ptr<Show>> shows;
  for (int t = 0; t < 200; ++t) {
    const PoseTrack track = MakeMotion(model->skeleton(), t % 10 + 1);
    shows.push_back(std::make_unique<Show>(model, track.poses().back(), nullptr));
  }
  {
    auto executor = std::make_unique<Executor>(4);
    PoseBatcher batcher(executor.get(), 8);
    std::vector<std::thread> threads;
    for (int p = 0; p < 4; ++p) {
      threads.emplace_back([&, p] {
        for (size_t t = p; t < shows.size(); t += 4) batcher.Submit(model.get(), shows[t].get());
      });
    }
    for (std::thread& thread : threads) thread.join();
    executor.reset();
  }
  for (const auto& show : shows) {
    EXPECT_TRUE(show->finished);
    EXPECT_THAT(show->status, IsOk());
    EXPECT_GE(show->num_together, 1);
    EXPECT_LE(show->num_together, 8);
  }
}

}  // namespace
}  // namespace pleat
