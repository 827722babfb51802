#include "pleat/local/local_poses.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "pleat/local/local_character_service.h"
#include "pleat/stream/frame_decoder.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

// Keeps the replies of a stream.
class Replies final : public LiveListener {
 public:
  void OnReply(LiveReply&& reply) override {
    std::lock_guard lock(mutex_);
    replies_.push_back(std::move(reply));
    changed_.notify_all();
  }
  // Waits for the reply `index`.
  LiveReply At(size_t index) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return replies_.size() > index; });
    return replies_[index];
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<LiveReply> replies_;  // guarded by mutex_
};

class LocalPosesTest : public testing::Test {
 protected:
  LocalPosesTest() {
    service_ = LocalCharacterService::Open({.data_dir = folder_.path(),
                                            .num_pose_threads = 2,
                                            .limits = {.max_frames = 20},
                                            .train = trainer_.function()})
                   .value();
    const std::string sequence = service_->sequences().Upload(MakeSwayingTube(5), {})->id;
    const std::string job = service_->jobs().CreateTraining({.sequence_ids = {sequence}})->id;
    EXPECT_THAT(WatchJob(service_->jobs(), job,
                         [&](const JobInfo& info) {
                           id_ = info.result_id;
                           return true;
                         }),
                IsOk());
    model_ = service_->models().Acquire(id_).value();
    track_ = MakeMotion(model_->skeleton(), 6);
  }
  std::unique_ptr<PoseStream> Open(LiveRules rules) {
    return service_->poses()
        .OpenStream(id_, {.encoder = {.position_bits = 16}}, rules, &replies_)
        .value();
  }

  TemporaryFolder folder_;
  FakeTrainer trainer_;
  std::unique_ptr<LocalCharacterService> service_;
  std::string id_;
  std::shared_ptr<const CharacterModel> model_;
  PoseTrack track_;
  Replies replies_;
};

TEST_F(LocalPosesTest, AStreamAnswersPosesInOrderWithTheirHistory) {
  const auto stream = Open({});
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder decoder, FrameDecoder::Create(stream->header()));
  for (int t = 0; t < 4; ++t) {
    stream->Push({.number = 100 + static_cast<uint64_t>(t), .pose = track_.pose(t)});
  }
  EXPECT_FALSE(stream->HasRoom());
  for (int t = 0; t < 4; ++t) {
    ASSERT_TRUE(stream->ready());
    stream->Answer();
    const LiveReply reply = replies_.At(t);
    EXPECT_EQ(reply.number, 100u + t);
    EXPECT_EQ(reply.num_superseded, 0);
    EXPECT_EQ(reply.num_together, 1);
    ASSERT_THAT(reply.frame, IsOk());
    EvaluatedFrame truth;
    const Pose& before = track_.pose(std::max(t - 1, 0));
    ASSERT_THAT(PoseEvaluator(model_).Evaluate({&track_.pose(t), &before}, {}, &truth), IsOk());
    Eigen::Matrix3Xf positions;
    ASSERT_THAT(decoder.Decode(reply.frame->draco, reply.frame->mark, &positions), IsOk());
    EXPECT_LE((positions - truth.positions).cwiseAbs().maxCoeff(), 2e-5);
  }
  EXPECT_TRUE(stream->empty());
  EXPECT_TRUE(stream->HasRoom());
}

TEST_F(LocalPosesTest, WithLatestWinsTheNewestPoseIsAnsweredWhileThereAreCredits) {
  const auto stream = Open({.max_in_flight = 1, .latest_wins = true});
  for (int t = 0; t < 3; ++t) {
    EXPECT_TRUE(stream->HasRoom());
    stream->Push({.number = static_cast<uint64_t>(t), .pose = track_.pose(t)});
  }
  stream->Answer();
  EXPECT_EQ(replies_.At(0).number, 2u);
  EXPECT_EQ(replies_.At(0).num_superseded, 2);
  stream->Push({.number = 3, .pose = track_.pose(3)});
  EXPECT_FALSE(stream->ready());
  EXPECT_FALSE(stream->empty());
  EXPECT_THAT(stream->Acknowledge(2), HasStatus(absl::StatusCode::kInvalidArgument, _));
  EXPECT_THAT(stream->Acknowledge(1), IsOk());
  EXPECT_TRUE(stream->ready());
  stream->Answer();
  EXPECT_EQ(replies_.At(1).number, 3u);
}

TEST_F(LocalPosesTest, APoseThatCannotBeShownIsAReply) {
  const auto stream = Open({});
  Pose short_pose = track_.pose(0);
  short_pose.rotations.pop_back();
  stream->Push({.number = 1, .pose = short_pose});
  stream->Push({.number = 2, .status = absl::InvalidArgumentError("unreadable")});
  stream->Push({.number = 3, .pose = track_.pose(0)});
  for (int i = 0; i < 3; ++i) {
    stream->Answer();
    replies_.At(i);
  }
  EXPECT_THAT(replies_.At(0).frame,
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("rotations")));
  EXPECT_THAT(replies_.At(1).frame, HasStatus(absl::StatusCode::kInvalidArgument, "unreadable"));
  EXPECT_THAT(replies_.At(2).frame, IsOk());
}

TEST_F(LocalPosesTest, RefusesClipsAboveTheLimitAndModelsThatAreNotThere) {
  const PoseTrack longer = MakeMotion(model_->skeleton(), 21);
  LocalPoses& poses = service_->poses();
  EXPECT_THAT(poses.OpenClip(id_, longer, {}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("max-frames")));
  EXPECT_THAT(poses.EvaluateClip({.model_id = id_, .track = longer, .bone_scales = {}},
                                 [](int, const EvaluatedFrame&) { return absl::OkStatus(); }),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("max-frames")));
  const std::string unknown(64, '0');
  EXPECT_THAT(poses.OpenSession(unknown, {}), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(poses.OpenClip(unknown, track_, {}), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(poses.OpenStream(unknown, {}, {}, &replies_),
              HasStatus(absl::StatusCode::kNotFound, _));
}

}  // namespace
}  // namespace pleat
