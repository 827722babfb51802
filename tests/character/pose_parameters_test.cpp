// The two halves of a query, and what every query promises about histories and limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "pleat/character/pose_evaluator.h"
#include "support/fake_training.h"
#include "support/not_a_number.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class PoseParametersTest : public ::testing::Test {
 protected:
  std::vector<const Pose*> History(int t, int count) const {
    std::vector<const Pose*> poses;
    for (int h = 0; h < count; ++h) poses.push_back(&track_.pose(t - h));
    return poses;
  }
  Eigen::Matrix3Xf Positions(const std::vector<const Pose*>& poses) {
    EvaluatedFrame frame;
    EXPECT_THAT(evaluator_.Evaluate(poses, {}, &frame), IsOk());
    return frame.positions;
  }

  const std::shared_ptr<const CharacterModel> model_ =
      MakeFakeModel(MakeSwayingTube(2), {.history = 3});
  const PoseTrack track_ = MakeMotion(model_->skeleton(), 20);
  PoseEvaluator evaluator_{model_};
};

TEST_F(PoseParametersTest, ShownParametersAreTheFrameWithinTwoMicrometers) {
  PoseEvaluator elsewhere(model_);
  for (int t = 3; t < 20; ++t) {
    for (const bool skinned_only : {false, true}) {
      FrameParameters parameters;
      EvaluatedFrame whole, shown, again;
      ASSERT_THAT(evaluator_.Predict(History(t, 3), skinned_only, &parameters), IsOk());
      EXPECT_EQ(parameters.coefficients.size(), skinned_only ? 0 : 2);
      ASSERT_THAT(evaluator_.Show(parameters, {}, &shown), IsOk());
      ASSERT_THAT(elsewhere.Show(parameters, {}, &again), IsOk());
      EXPECT_EQ(shown.positions, again.positions);
      ASSERT_THAT(skinned_only ? evaluator_.EvaluateSkinned(track_.pose(t), {}, &whole)
                               : evaluator_.Evaluate(History(t, 3), {}, &whole),
                  IsOk());
      EXPECT_LT((shown.positions - whole.positions).cwiseAbs().maxCoeff(), 2e-6f) << t;
      EXPECT_EQ(shown.confidence, whole.confidence);
    }
  }
}

// Rows of the caller take the place of the frame's own positions, in a batch and when shown.
TEST_F(PoseParametersTest, PositionsGoIntoTheRowsOfTheCaller) {
  constexpr int kStride = 6;
  const std::vector<const Pose*> poses = History(9, 3);
  const Eigen::Matrix3Xf expected = Positions(poses);
  std::vector<float> buffer(static_cast<size_t>(kStride) * model_->num_vertices(), 4);
  const VertexRows rows{.data = buffer.data() + 1, .stride = kStride};
  EvaluatedFrame frame;
  PoseQuery query{.poses = &poses, .frame = &frame, .rows = rows};
  evaluator_.EvaluateBatch({&query, 1});
  ASSERT_THAT(query.status, IsOk());
  EXPECT_EQ(frame.positions.size(), 0);
  EXPECT_GT(frame.confidence, 0);
  const auto rows_hold = [&](const Eigen::Matrix3Xf& positions) {
    for (int v = 0; v < model_->num_vertices(); ++v) {
      if (Eigen::Map<Eigen::Vector3f>(rows.row(v)) != positions.col(v)) return false;
      if (buffer[kStride * v] != 4 || buffer[kStride * v + 5] != 4) return false;
    }
    return true;
  };
  EXPECT_TRUE(rows_hold(expected));

  FrameParameters parameters;
  EvaluatedFrame shown;
  ASSERT_THAT(evaluator_.Predict(poses, false, &parameters), IsOk());
  ASSERT_THAT(evaluator_.Show(parameters, {}, &shown), IsOk());
  ASSERT_THAT(evaluator_.Show(parameters, {}, &frame, rows), IsOk());
  EXPECT_TRUE(rows_hold(shown.positions));
}

TEST_F(PoseParametersTest, AClipGoesIntoTheRowsOfTheCaller) {
  const int num_vertices = model_->num_vertices();
  std::vector<Eigen::Matrix3Xf> expected, found(20, Eigen::Matrix3Xf(3, num_vertices));
  const auto keep = [&](int, const EvaluatedFrame& frame) {
    expected.push_back(frame.positions);
    return absl::OkStatus();
  };
  ASSERT_THAT(evaluator_.EvaluateClip(track_, {}, keep), IsOk());
  std::vector<VertexRows> rows;
  for (Eigen::Matrix3Xf& frame : found) rows.push_back(RowsOf(&frame));
  const auto is_empty = [](int, const EvaluatedFrame& frame) {
    return frame.positions.size() == 0 ? absl::OkStatus() : absl::InternalError("a frame");
  };
  ASSERT_THAT(evaluator_.EvaluateClip(track_, {}, is_empty, {}, rows), IsOk());
  EXPECT_EQ(found, expected);
}

TEST_F(PoseParametersTest, ParametersTravelAsFloat32AndNormalized) {
  Pose longer = track_.pose(5);
  for (Eigen::Quaterniond& rotation : longer.rotations) rotation.coeffs() *= 1.005;
  FrameParameters parameters;
  ASSERT_THAT(evaluator_.Predict({&longer}, false, &parameters), IsOk());
  for (const Eigen::Quaterniond& rotation : parameters.pose.rotations) {
    EXPECT_NEAR(rotation.norm(), 1, 1e-6);
    const Eigen::Quaternionf rounded = rotation.cast<float>();
    EXPECT_EQ(rounded.cast<double>().coeffs(), rotation.coeffs());
  }
}

TEST_F(PoseParametersTest, ParametersOfAnotherModelAreNamed) {
  FrameParameters good;
  ASSERT_THAT(evaluator_.Predict(History(5, 3), false, &good), IsOk());
  EvaluatedFrame frame;
  const auto refused = [&](const FrameParameters& bad, const char* word) {
    EXPECT_THAT(evaluator_.Show(bad, {}, &frame),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(word)));
    EXPECT_EQ(frame.positions.size(), 0) << "untouched";
  };
  FrameParameters bad = good;
  bad.coefficients = Eigen::VectorXf::Zero(3);
  refused(bad, "another model");
  bad = good;
  bad.coefficients[1] = std::numeric_limits<float>::infinity();
  refused(bad, "not finite");
  bad = good;
  bad.pose.rotations.pop_back();
  refused(bad, "2 rotations");
  bad = good;
  bad.pose.rotations[1].x() = kNan;
  refused(bad, "joint 1");
  EXPECT_THAT(evaluator_.Show(good, {1}, &frame),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("bone scales")));
}

TEST_F(PoseParametersTest, MissingHistoryRepeatsTheOldestAndMoreIsNotLookedAt) {
  const Pose &now = track_.pose(8), &before = track_.pose(7);
  EXPECT_EQ(Positions({&now, &before}), Positions({&now, &before, &before}));
  EXPECT_EQ(Positions({&now}), Positions({&now, &now, &now}));
  EXPECT_NE(Positions({&now}), Positions({&now, &before, &before}));
  // Beyond the model's history even a broken pose is no matter.
  Pose broken = now;
  broken.rotations.clear();
  EXPECT_EQ(Positions({&now, &before, &before, &broken}), Positions({&now, &before}));
  EvaluatedFrame frame;
  EXPECT_FALSE(evaluator_.Evaluate({&now, &broken}, {}, &frame).ok());
  EXPECT_THAT(evaluator_.EvaluateSkinned(now, {}, &frame), IsOk());
}

TEST_F(PoseParametersTest, BoneScalesAreAllowedUpToTheirLimits) {
  EvaluatedFrame frame;
  for (const double scale : {.05, 1., 20.}) {
    EXPECT_THAT(evaluator_.Evaluate(History(5, 1), {1, scale, 1}, &frame), IsOk()) << scale;
    EXPECT_TRUE(frame.positions.allFinite());
  }
  for (const double scale : {.0499, 20.01, 0., -1., kNan}) {
    EXPECT_THAT(evaluator_.Evaluate(History(5, 1), {1, scale, 1}, &frame),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("joint 1")))
        << scale;
  }
  EXPECT_EQ(Positions(History(5, 3)), [&] {
    EXPECT_THAT(evaluator_.Evaluate(History(5, 3), {1, 1, 1}, &frame), IsOk());
    return frame.positions;
  }());
}

TEST_F(PoseParametersTest, AClipEndsWithItsConsumerAndKnowsItsSkeleton) {
  int num_frames = 0;
  const auto stop = [&](int t, const EvaluatedFrame&) {
    EXPECT_EQ(t, num_frames++);
    return t == 9 ? absl::AbortedError("enough") : absl::OkStatus();  // in the second batch
  };
  EXPECT_THAT(evaluator_.EvaluateClip(track_, {}, stop),
              HasStatus(absl::StatusCode::kAborted, "enough"));
  EXPECT_EQ(num_frames, 10);
  num_frames = 0;
  EXPECT_THAT(evaluator_.EvaluateSkinnedClip(track_, {}, stop),
              HasStatus(absl::StatusCode::kAborted, "enough"));
  const Skeleton two = Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b", 0, {0, 1, 0}}}).value();
  const auto never = [](int, const EvaluatedFrame&) { return absl::InternalError("a frame"); };
  for (const bool skinned : {false, true}) {
    const PoseTrack other = MakeMotion(two, 3);
    EXPECT_THAT(skinned ? evaluator_.EvaluateSkinnedClip(other, {}, never)
                        : evaluator_.EvaluateClip(other, {}, never),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("2 rotations")));
    const Progress cancelled({}, [] { return true; });
    const auto take = [](int, const EvaluatedFrame&) { return absl::OkStatus(); };
    EXPECT_TRUE(absl::IsCancelled(skinned
                                      ? evaluator_.EvaluateSkinnedClip(track_, {}, take, cancelled)
                                      : evaluator_.EvaluateClip(track_, {}, take, cancelled)));
  }
}

// Sessions lend their memory to whoever evaluates their queries together.
TEST_F(PoseParametersTest, LentMemoryGivesTheSameBits) {
  std::vector<PoseEvaluator> lenders;
  std::vector<std::vector<const Pose*>> poses;
  std::vector<EvaluatedFrame> frames(5);
  for (int q = 0; q < 5; ++q) {
    lenders.emplace_back(model_);
    poses.push_back(History(4 + q, 3));
  }
  std::vector<PoseQuery> queries(5);
  for (int q = 0; q < 5; ++q) {
    queries[q] = {.poses = &poses[q],
                  .skinned_only = q == 2,
                  .frame = &frames[q],
                  .scratch_of = q == 3 ? nullptr : &lenders[q]};
  }
  evaluator_.EvaluateBatch(queries);
  for (int q = 0; q < 5; ++q) {
    ASSERT_THAT(queries[q].status, IsOk());
    EvaluatedFrame expected;
    ASSERT_THAT(q == 2 ? evaluator_.EvaluateSkinned(*poses[q][0], {}, &expected)
                       : evaluator_.Evaluate(poses[q], {}, &expected),
                IsOk());
    EXPECT_EQ(frames[q].positions, expected.positions) << q;
  }
  evaluator_.EvaluateBatch({});
}

}  // namespace
}  // namespace pleat
