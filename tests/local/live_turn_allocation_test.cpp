// Whole live turns as the server plays them, through a PoseStream: pose -> queue -> batch ->
// evaluation -> encoding -> bytes. In the steady state they allocate nothing. What is left to Draco
// does: every frame of the encodings mesh and points, and of a stream of differences the key frames
// (the first one, those a client asks for, those after a cut) and differences of meshes with too
// few vertices for ResidualWriter. The messages of gRPC are not counted here; they belong to the
// transport.
#include <gtest/gtest.h>

#include <memory>
#include <semaphore>
#include <utility>
#include <vector>

#include "local_pose_stream.h"
#include "pleat/local/pose_batcher.h"
#include "pleat/local/pose_session.h"
#include "pleat/local/project_quota.h"
#include "support/allocation_counter.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

constexpr int kNumPoses = 60;

std::shared_ptr<const CharacterModel> LargeTube() {
  static const auto model =
      MakeFakeModel(MakeSwayingTube(5, "tube", /*rings=*/100, /*sides=*/60), TrainOptions());
  return model;
}

// A motion that is slow enough for differences to be cheaper than key frames.
std::vector<LivePose> SlowMotion(const CharacterModel& model) {
  std::vector<LivePose> poses;
  for (int t = 0; t < kNumPoses; ++t) {
    LivePose pose{.number = static_cast<uint64_t>(t), .pose = Pose::Rest(model.skeleton())};
    for (size_t j = 0; j < pose.pose.rotations.size(); ++j) {
      pose.pose.rotations[j] =
          Eigen::AngleAxisd(.05 * std::sin(.2 * t + static_cast<double>(j)),
                            Eigen::Vector3d(.3, .5, static_cast<double>(j) + 1).normalized());
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

// A live session without its network: what its handler does between its messages.
class Client final : public LiveListener {
 public:
  Client(const LiveRules& rules, PoseSessionOptions options, PoseBatcher* batcher)
      : stream_(LocalPoseSession::Open(LargeTube(), std::move(options)).value(), rules, &quota_,
                batcher, this) {}

  void Send(const LivePose& pose) { stream_.Push(pose); }
  void Answer() { stream_.Answer(); }
  // Waits for the reply of a turn.
  void Receive() {
    done_.acquire();
    if (status_.ok()) status_ = stream_.Acknowledge(++num_received_);  // an expectation allocates
  }

  const absl::Status& status() const { return status_; }
  const EncodedFrame& frame() const { return frame_; }
  int num_keyframes() const { return num_keyframes_; }

  // Takes the frame as the transport does, which gives one of its own in exchange. That one is made
  // with the first reply, as large as what comes.
  void OnReply(LiveReply&& reply) override {
    status_ = reply.frame.status();
    if (status_.ok()) {
      if (num_received_ == 0) {
        frame_ = *reply.frame;
        frame_.draco.reserve(reply.frame->draco.capacity());
      }
      std::swap(frame_, *reply.frame);
      num_keyframes_ += frame_.mark.keyframe;
    }
    done_.release();
  }

 private:
  EncodedFrame frame_;
  absl::Status status_;
  uint64_t num_received_ = 0;
  int num_keyframes_ = 0;
  std::counting_semaphore<> done_{0};
  ProjectQuota quota_{ProjectQuota::OfFrames(kDefaultProject,
                                             1e9)};  // a limit that is there costs no memory either
  LocalPoseStream stream_;
};

class LiveTurnAllocationTest : public testing::Test {
 protected:
  void SetUp() override {
    if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted here";
  }

  Client* Add(const LiveRules& rules, PoseSessionOptions options) {
    clients_.push_back(std::make_unique<Client>(rules, std::move(options), &batcher_));
    return clients_.back().get();
  }

  // One turn of every client; returns the allocations of the process meanwhile.
  long Turn(const LivePose& pose, int poses_per_turn = 1) {
    const long before = NumAllocations();
    for (const auto& client : clients_) {
      for (int i = 0; i < poses_per_turn; ++i) client->Send(pose);
      client->Answer();
    }
    for (const auto& client : clients_) client->Receive();
    const long count = NumAllocations() - before;
    for (const auto& client : clients_) EXPECT_THAT(client->status(), IsOk());
    return count;
  }

  // The allocations of all turns but the first, which encodes a key frame.
  long TurnsAfterTheFirst(int poses_per_turn = 1) {
    long count = 0;
    for (int t = 0; t < kNumPoses; ++t) {
      const long of_turn = Turn(poses_[t], poses_per_turn);
      if (t >= 1) count += of_turn;
    }
    return count;
  }

  const std::vector<LivePose> poses_ = SlowMotion(*LargeTube());
  PoseBatcher batcher_{&executor_, 8};  // does not use the executor yet
  std::vector<std::unique_ptr<Client>> clients_;
  Executor executor_{2};  // its tasks use all above
};

constexpr FrameEncoderOptions kDifferences{.encoding = FrameEncoding::kDracoDelta};

TEST_F(LiveTurnAllocationTest, DifferencesOfTheMesh) {
  const Client* client = Add({}, {.encoder = kDifferences});
  EXPECT_EQ(TurnsAfterTheFirst(), 0);
  EXPECT_EQ(client->num_keyframes(), 1) << "the motion is too fast for this test";
  EXPECT_FALSE(client->frame().draco.empty());
}

TEST_F(LiveTurnAllocationTest, DifferencesOfTheControlMesh) {
  FrameEncoderOptions options = kDifferences;
  options.content = StreamContent::kControlMesh;
  options.position_bits = 8;  // few vertices: a narrow range suits ResidualWriter
  const Client* client = Add({}, {.encoder = options});
  EXPECT_EQ(TurnsAfterTheFirst(), 0);
  EXPECT_EQ(client->num_keyframes(), 1);
}

TEST_F(LiveTurnAllocationTest, Parameters) {
  FrameEncoderOptions options;
  options.content = StreamContent::kParameters;
  const Client* client = Add({}, {.encoder = options});
  EXPECT_EQ(TurnsAfterTheFirst(), 0);
  ASSERT_TRUE(client->frame().parameters.has_value());
  EXPECT_GT(client->frame().parameters->coefficients.size(), 0);
}

TEST_F(LiveTurnAllocationTest, PosesThatSupersedeEachOther) {
  Add({.latest_wins = true}, {.encoder = kDifferences});
  EXPECT_EQ(TurnsAfterTheFirst(/*poses_per_turn=*/3), 0);
}

TEST_F(LiveTurnAllocationTest, ManySessionsOfOneModelInBatchesOfAnySize) {
  FrameEncoderOptions parameters;
  parameters.content = StreamContent::kParameters;
  for (int c = 0; c < 3; ++c) {
    Add({}, {.encoder = kDifferences});
    Add({}, {.encoder = parameters});
    Add({}, {.skinned_only = true, .encoder = kDifferences});
  }
  // How turns share batches, and how many wait at once, depends on the threads. Nothing may grow
  // with it.
  EXPECT_EQ(TurnsAfterTheFirst(), 0);
}

TEST_F(LiveTurnAllocationTest, CutsAndGivenHistories) {
  FrameEncoderOptions parameters;
  parameters.content = StreamContent::kParameters;
  Add({}, {.encoder = parameters});
  Turn(poses_[0]);
  LivePose cut = poses_[2], with_history = poses_[3];
  cut.restart = true;
  with_history.history = {poses_[2].pose, poses_[1].pose, poses_[0].pose};
  long count = Turn(poses_[1]) + Turn(cut) + Turn(poses_[3]) + Turn(poses_[4]) + Turn(with_history);
  count += Turn(poses_[4]) + Turn(cut);
  EXPECT_EQ(count, 0);
}

// The frame after a key frame that was asked for finds all memory where it was.
TEST_F(LiveTurnAllocationTest, OnlyTheKeyFrameItselfAllocates) {
  const Client* client = Add({}, {.encoder = kDifferences});
  for (int t = 0; t < 5; ++t) Turn(poses_[t]);
  LivePose pose = poses_[5];
  pose.keyframe = true;
  EXPECT_GT(Turn(pose), 0) << "Draco allocates no more: say so in docs/performance.md";
  EXPECT_EQ(client->num_keyframes(), 2);
  EXPECT_EQ(Turn(poses_[6]), 0);
}

// A count that grows by itself would be a leak of ours, not Draco's.
TEST_F(LiveTurnAllocationTest, DracoAllocatesTheSameForEveryFrame) {
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud}) {
    clients_.clear();
    Add({}, {.encoder = {.encoding = encoding}});
    for (int t = 0; t < 5; ++t) Turn(poses_[t]);
    const long first = Turn(poses_[5]), second = Turn(poses_[6]);
    RecordProperty(encoding == FrameEncoding::kDracoMesh ? "mesh" : "points",
                   static_cast<int>(first));
    EXPECT_GT(first, 0);
    EXPECT_NEAR(static_cast<double>(first), static_cast<double>(second),
                .1 * static_cast<double>(first));
  }
}

}  // namespace
}  // namespace pleat
