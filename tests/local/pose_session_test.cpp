#include "pleat/local/pose_session.h"

#include <gtest/gtest.h>

#include "pleat/stream/frame_decoder.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class PoseSessionTest : public testing::Test {
 protected:
  std::shared_ptr<const CharacterModel> model_ = MakeFakeModel(MakeSwayingTube(5), TrainOptions());
  const PoseTrack track_ = MakeMotion(model_->skeleton(), 12);

  // Largest coordinate error of `decoded` against `truth`, in steps of the grid.
  static double Steps(const Eigen::Matrix3Xf& decoded, const Eigen::Matrix3Xf& truth,
                      const QuantizationBox& box) {
    return (decoded - truth).cwiseAbs().maxCoeff() / box.step_m();
  }
};

TEST_F(PoseSessionTest, ClipFramesDecodeToTheEvaluatorsPositions) {
  for (const FrameEncoding encoding :
       {FrameEncoding::kDracoMesh, FrameEncoding::kDracoPointCloud, FrameEncoding::kDracoDelta}) {
    for (const double fps : {25.0, 60.0}) {
      const PoseTrack track =
          PoseTrack::FromValid({.fps = fps, .poses = track_.poses(), .clip_starts = {0, 5}});
      std::vector<EvaluatedFrame> truth;
      PoseEvaluator evaluator(model_);
      ASSERT_THAT(evaluator.EvaluateClip(track, {},
                                         [&](int, const EvaluatedFrame& frame) {
                                           truth.push_back(frame);
                                           return absl::OkStatus();
                                         }),
                  IsOk());
      PLEAT_ASSERT_OK_AND_ASSIGN(
          const auto clip,
          LocalClipSession::Open(model_, track, {.encoder = {.encoding = encoding}}));
      PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder decoder, FrameDecoder::Create(clip->header()));
      for (int t = 0; t < track.num_frames(); ++t) {
        ASSERT_FALSE(clip->done());
        EXPECT_EQ(clip->next_frame(), t);
        PLEAT_ASSERT_OK_AND_ASSIGN(const EncodedFrame frame, clip->Next());
        Eigen::Matrix3Xf positions;
        ASSERT_THAT(decoder.Decode(frame.draco, frame.mark, &positions), IsOk());
        EXPECT_LE(Steps(positions, truth[t].positions, clip->header().box), .505);
        EXPECT_EQ(frame.confidence, truth[t].confidence);
      }
      EXPECT_TRUE(clip->done());
    }
  }
}

TEST_F(PoseSessionTest, SkinnedOnlyLeavesTheDetailOut) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const auto session,
      LocalPoseSession::Open(model_, {.skinned_only = true, .encoder = {.position_bits = 20}}));
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder decoder, FrameDecoder::Create(session->header()));
  EvaluatedFrame truth;
  ASSERT_THAT(PoseEvaluator(model_).EvaluateSkinned(track_.pose(3), {}, &truth), IsOk());
  Eigen::Matrix3Xf positions;
  ASSERT_THAT(decoder.Decode(session->Show({&track_.pose(3)})->draco, &positions), IsOk());
  EXPECT_LE((positions - truth.positions).cwiseAbs().maxCoeff(), 1e-5);
}

TEST_F(PoseSessionTest, RefusesWhatDoesNotFit) {
  EXPECT_THAT(LocalPoseSession::Open(model_, {.bone_scales = {1, 1}, .encoder = {}}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("bone scales")));
  EXPECT_THAT(LocalPoseSession::Open(model_, {.bone_scales = {1, 1, 1000}, .encoder = {}}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("1000")));
  PoseTrack::Parts wrong = track_.parts();
  for (Pose& pose : wrong.poses) pose.rotations.pop_back();
  EXPECT_THAT(LocalClipSession::Open(model_, PoseTrack::FromValid(wrong), {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("2 rotations")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, LocalPoseSession::Open(model_, {}));
  EXPECT_FALSE(session->Show({}).ok());
  EXPECT_FALSE(session->Show({&wrong.poses[4]}).ok());
  PoseTrack::Parts far = track_.parts();
  far.poses[2].root_position.x() = 1e6;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto clip,
                             LocalClipSession::Open(model_, PoseTrack::FromValid(far), {}));
  ASSERT_THAT(clip->Next(), IsOk());
  ASSERT_THAT(clip->Next(), IsOk());
  EXPECT_THAT(clip->Next(), HasStatus(absl::StatusCode::kOutOfRange, HasSubstr("frame 2")));
}

}  // namespace
}  // namespace pleat
