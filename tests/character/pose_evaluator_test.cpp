#include "pleat/character/pose_evaluator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "pleat/character/fit_motion.h"
#include "pleat/fitting/details.h"
#include "pleat/skeleton/human_template.h"
#include "support/allocation_counter.h"
#include "support/status_matchers.h"
#include "trained_performer.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

const PoseTrack& TrainingTrack() {
  static const PoseTrack track = FitMotion(*SmallCharacter(), SmallPerformer().sequence).value();
  return track;
}

double BoneLength(const CharacterModel& model, const Pose& pose, const std::vector<double>& scales,
                  int joint) {
  BoneTransforms transforms;
  ComputeBoneTransforms(model.skeleton(), pose, scales, &transforms);
  return (transforms.joint_positions.col(joint) -
          transforms.joint_positions.col(model.skeleton().parent(joint)))
      .norm();
}

TEST(PoseEvaluatorTest, TrainingPosesGiveTheTrainingFrames) {
  PoseEvaluator evaluator(SmallCharacter());
  double worst_mean_m = 0, lowest_confidence = 1;
  ASSERT_THAT(evaluator.EvaluateClip(TrainingTrack(), {},
                                     [&](int t, const EvaluatedFrame& frame) {
                                       const Eigen::Matrix3Xf difference =
                                           frame.positions - SmallPerformer().sequence.frame(t);
                                       worst_mean_m = std::max<double>(
                                           worst_mean_m, difference.colwise().norm().mean());
                                       lowest_confidence =
                                           std::min(lowest_confidence, frame.confidence);
                                       return absl::OkStatus();
                                     }),
              IsOk());
  EXPECT_LT(worst_mean_m, 0.003);
  EXPECT_GT(lowest_confidence, 0.8);
}

TEST(PoseEvaluatorTest, ConfidenceFallsFarFromTraining) {
  PoseEvaluator evaluator(SmallCharacter());
  Pose strange = TrainingTrack().pose(10);
  for (int j = 1; j < kNumHumanJoints; ++j) {
    strange.rotations[j] = Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitX());
  }
  EvaluatedFrame seen, unseen;
  ASSERT_THAT(evaluator.Evaluate({&TrainingTrack().pose(10), &TrainingTrack().pose(9)}, {}, &seen),
              IsOk());
  ASSERT_THAT(evaluator.Evaluate({&strange}, {}, &unseen), IsOk());
  EXPECT_GT(seen.confidence, 0.8);
  EXPECT_LT(unseen.confidence, 0.3);
  EXPECT_TRUE(unseen.positions.allFinite());
}

// Between `from` and `to`, every joint but the root, whose pose is that of `from`.
Pose Between(const Pose& from, const Pose& to, double s) {
  Pose pose = from;
  for (size_t j = 1; j < pose.rotations.size(); ++j) {
    pose.rotations[j] = from.rotations[j].slerp(s, to.rotations[j]);
  }
  return pose;
}

// What the detail adds to skinning at `pose`, which has been held: 3 x V.
Eigen::Matrix3Xf DetailAt(PoseEvaluator& evaluator, const Pose& pose, double* confidence) {
  EvaluatedFrame hybrid, skinned;
  EXPECT_THAT(evaluator.Evaluate({&pose}, {}, &hybrid), IsOk());
  EXPECT_THAT(evaluator.EvaluateSkinned(pose, {}, &skinned), IsOk());
  *confidence = hybrid.confidence;
  return hybrid.positions - skinned.positions;
}

// Largest change of a vertex's detail in one of `num_steps` from pose to pose, meters.
double LargestDetailStep(PoseEvaluator& evaluator, const Pose& from, const Pose& to,
                         int num_steps) {
  double confidence = 0, largest = 0;
  Eigen::Matrix3Xf last = DetailAt(evaluator, from, &confidence);
  for (int i = 1; i <= num_steps; ++i) {
    const Eigen::Matrix3Xf detail =
        DetailAt(evaluator, Between(from, to, static_cast<double>(i) / num_steps), &confidence);
    largest = std::max<double>(largest, (detail - last).colwise().norm().maxCoeff());
    last = detail;
  }
  return largest;
}

TEST(PoseEvaluatorTest, APoseThatLeavesTrainingNeverPops) {
  PoseEvaluator evaluator(SmallCharacter());
  const Pose seen = TrainingTrack().pose(10);
  Pose strange = seen;
  for (int j = 1; j < kNumHumanJoints; ++j) {
    strange.rotations[j] = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX());
  }
  // A jump would not get smaller with the steps; what moves steadily does, in proportion.
  const double coarse = LargestDetailStep(evaluator, seen, strange, 100);
  const double fine = LargestDetailStep(evaluator, seen, strange, 400);
  EXPECT_LT(coarse, .02);  // meters, while every joint turns by almost a degree
  EXPECT_LT(fine, .4 * coarse);

  // The way ends with no confidence left, and with details of the size of those in training: the
  // learner does not fade, and does not run away either, however long the pose stays.
  double confidence = 1, largest_seen = 0, largest_strange = 0;
  for (int t = 0; t < TrainingTrack().num_frames(); t += 5) {
    largest_seen = std::max<double>(
        largest_seen,
        DetailAt(evaluator, TrainingTrack().pose(t), &confidence).colwise().norm().maxCoeff());
  }
  for (const double turn : {1.5, 2.0, 2.5, 3.0}) {
    for (int j = 1; j < kNumHumanJoints; ++j) {
      strange.rotations[j] = Eigen::AngleAxisd(turn, Eigen::Vector3d(1, .2 * j, -.3).normalized());
    }
    largest_strange = std::max<double>(
        largest_strange, DetailAt(evaluator, strange, &confidence).colwise().norm().maxCoeff());
    EXPECT_LT(confidence, .02);
  }
  EXPECT_LT(largest_strange, 4 * largest_seen);
}

TEST(PoseEvaluatorTest, FollowsARigidMotionOfTheWholePose) {
  PoseEvaluator evaluator(SmallCharacter());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitY()));
  const Eigen::Vector3d shift(3, 0, -2);
  const auto moved = [&](Pose pose) {
    pose.root_position = turn * pose.root_position + shift;
    pose.rotations[0] = turn * pose.rotations[0];
    return pose;
  };
  const Pose now = TrainingTrack().pose(20), before = TrainingTrack().pose(19);
  const Pose now_moved = moved(now), before_moved = moved(before);
  EvaluatedFrame frame, frame_moved;
  ASSERT_THAT(evaluator.Evaluate({&now, &before}, {}, &frame), IsOk());
  ASSERT_THAT(evaluator.Evaluate({&now_moved, &before_moved}, {}, &frame_moved), IsOk());
  const Eigen::Matrix3Xf expected =
      (turn.cast<float>().toRotationMatrix() * frame.positions).colwise() + shift.cast<float>();
  EXPECT_LT((frame_moved.positions - expected).cwiseAbs().maxCoeff(), 1e-4f);
}

TEST(PoseEvaluatorTest, DoublingTheFrameRateKeepsTheFrames) {
  // The same motion at twice the rate: history is taken at the model's own interval.
  PoseTrack::Parts parts{.fps = 2 * TrainingTrack().fps()};
  for (int t = 0; t + 1 < TrainingTrack().num_frames(); ++t) {
    parts.poses.push_back(TrainingTrack().pose(t));
    Pose middle = TrainingTrack().pose(t);
    const Pose& next = TrainingTrack().pose(t + 1);
    middle.root_position = (middle.root_position + next.root_position) / 2;
    for (int j = 0; j < kNumHumanJoints; ++j) {
      middle.rotations[j] = middle.rotations[j].slerp(0.5, next.rotations[j]);
    }
    parts.poses.push_back(middle);
  }
  const PoseTrack fast = PoseTrack::FromValid(std::move(parts));
  PoseEvaluator evaluator(SmallCharacter());
  std::vector<Eigen::Matrix3Xf> slow_frames;
  ASSERT_THAT(evaluator.EvaluateClip(TrainingTrack(), {},
                                     [&](int, const EvaluatedFrame& frame) {
                                       slow_frames.push_back(frame.positions);
                                       return absl::OkStatus();
                                     }),
              IsOk());
  float worst = 0;
  ASSERT_THAT(evaluator.EvaluateClip(
                  fast, {},
                  [&](int t, const EvaluatedFrame& frame) {
                    if (t >= 2 && t % 2 == 0) {
                      worst = std::max(
                          worst, (frame.positions - slow_frames[t / 2]).cwiseAbs().maxCoeff());
                    }
                    return absl::OkStatus();
                  }),
              IsOk());
  EXPECT_LT(worst, 1e-4f);
}

TEST(PoseEvaluatorTest, ASkinnedClipIsItsFramesWithoutDetail) {
  PoseEvaluator evaluator(SmallCharacter());
  std::vector<Eigen::Matrix3Xf> frames;
  ASSERT_THAT(evaluator.EvaluateSkinnedClip(TrainingTrack(), {},
                                            [&](int t, const EvaluatedFrame& frame) {
                                              EXPECT_EQ(t, static_cast<int>(frames.size()));
                                              frames.push_back(frame.positions);
                                              return absl::OkStatus();
                                            }),
              IsOk());
  ASSERT_EQ(static_cast<int>(frames.size()), TrainingTrack().num_frames());
  EvaluatedFrame expected;
  ASSERT_THAT(evaluator.EvaluateSkinned(TrainingTrack().pose(3), {}, &expected), IsOk());
  EXPECT_EQ(frames[3], expected.positions);
}

TEST(PoseEvaluatorTest, BoneScalesGiveNewProportions) {
  std::vector<double> scales(kNumHumanJoints, 1.0);
  scales[kLeftLowerLeg] = 1.5;
  const Pose& pose = TrainingTrack().pose(0);
  EXPECT_NEAR(BoneLength(*SmallCharacter(), pose, scales, kLeftLowerLeg),
              1.5 * BoneLength(*SmallCharacter(), pose, {}, kLeftLowerLeg), 1e-9);
  PoseEvaluator evaluator(SmallCharacter());
  EvaluatedFrame plain, scaled;
  ASSERT_THAT(evaluator.Evaluate({&pose}, {}, &plain), IsOk());
  ASSERT_THAT(evaluator.Evaluate({&pose}, scales, &scaled), IsOk());
  // The left foot hangs lower by half a thigh, the head stays.
  EXPECT_LT(scaled.positions.row(1).minCoeff(), plain.positions.row(1).minCoeff() - 0.1f);
  EXPECT_NEAR(scaled.positions.row(1).maxCoeff(), plain.positions.row(1).maxCoeff(), 1e-5);
}

TEST(PoseEvaluatorTest, DoesNotAllocateAfterTheFirstFrame) {
  if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted here";
  PoseEvaluator evaluator(SmallCharacter());
  EvaluatedFrame frame;
  const std::vector<double> scales(kNumHumanJoints, 1.1);
  const std::vector<const Pose*> poses = {&TrainingTrack().pose(5), &TrainingTrack().pose(4)};
  ASSERT_THAT(evaluator.Evaluate(poses, scales, &frame), IsOk());
  const long before = NumAllocations();
  const absl::Status status = evaluator.Evaluate(poses, scales, &frame);
  const long num_allocations = NumAllocations() - before;
  EXPECT_THAT(status, IsOk());
  EXPECT_EQ(num_allocations, 0);
}

// The same frame in double precision, from the parts of the model.
Eigen::Matrix3Xd EvaluateInDoublePrecision(const CharacterModel& model,
                                           const std::vector<const Pose*>& poses) {
  Eigen::VectorXd features(model.features().num_features());
  model.features().ComputeRow(poses, features);
  DetailModel::Workspace workspace;
  Eigen::VectorXf coefficients(model.full_basis().num_coefficients());
  model.detail_model().PredictCoefficients(features, &workspace, coefficients);
  const Eigen::VectorXd details = model.full_basis().Mean().cast<double>() +
                                  model.full_basis().Dense() * coefficients.cast<double>();
  BoneTransforms transforms;
  ComputeBoneTransforms(model.skeleton(), *poses[0], {}, &transforms);
  std::vector<int> all(model.num_vertices());
  std::iota(all.begin(), all.end(), 0);
  std::vector<Eigen::Quaterniond> rotations;
  ComputeDetailRotations(DetailAxes::kLocal, model.rig().weights, all, transforms, &rotations);
  Eigen::Matrix3Xd positions;
  SkinVertices(model.rig().weights, model.rig().rest_positions, transforms, &positions);
  ApplyDetails(positions, rotations, details, &positions);
  return positions;
}

TEST(PoseEvaluatorTest, SinglePrecisionIsWithinAHundredthOfAMillimeter) {
  PoseEvaluator evaluator(SmallCharacter());
  EvaluatedFrame frame;
  for (const int t : {1, 9, 20}) {
    const std::vector<const Pose*> poses = {&TrainingTrack().pose(t), &TrainingTrack().pose(t - 1)};
    ASSERT_THAT(evaluator.Evaluate(poses, {}, &frame), IsOk());
    const Eigen::Matrix3Xd expected = EvaluateInDoublePrecision(*SmallCharacter(), poses);
    EXPECT_LT((frame.positions.cast<double>() - expected).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST(PoseEvaluatorTest, ABatchGivesTheBitsOfSingleQueries) {
  PoseEvaluator evaluator(SmallCharacter()), single(SmallCharacter());
  constexpr int kNumQueries = 21;  // more than are answered together
  std::vector<std::vector<const Pose*>> poses;
  std::vector<EvaluatedFrame> frames(kNumQueries);
  std::vector<PoseQuery> queries(kNumQueries);
  const std::vector<double> scales(kNumHumanJoints, 1.1), wrong_scales = {1, 2};
  for (int q = 0; q < kNumQueries; ++q) {
    poses.push_back({&TrainingTrack().pose(q + 1), &TrainingTrack().pose(q)});
  }
  for (int q = 0; q < kNumQueries; ++q) {
    queries[q] = {.poses = &poses[q],
                  .bone_scales = q % 5 == 2 ? &scales : nullptr,
                  .skinned_only = q % 4 == 1,
                  .frame = &frames[q]};
  }
  queries[7].bone_scales = &wrong_scales;
  evaluator.EvaluateBatch(queries);
  for (int q = 0; q < kNumQueries; ++q) {
    if (q == 7) {
      EXPECT_THAT(queries[q].status,
                  HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("bone scales")));
      EXPECT_EQ(frames[q].positions.size(), 0);
      continue;
    }
    ASSERT_THAT(queries[q].status, IsOk());
    EvaluatedFrame expected;
    const std::vector<double>& query_scales =
        queries[q].bone_scales ? *queries[q].bone_scales : std::vector<double>{};
    if (queries[q].skinned_only) {
      ASSERT_THAT(single.EvaluateSkinned(*poses[q][0], query_scales, &expected), IsOk());
    } else {
      ASSERT_THAT(single.Evaluate(poses[q], query_scales, &expected), IsOk());
    }
    EXPECT_EQ(frames[q].positions, expected.positions) << q;
    EXPECT_EQ(frames[q].confidence, expected.confidence) << q;
  }
}

TEST(PoseEvaluatorTest, BadPosesAreRefusedWithWords) {
  PoseEvaluator evaluator(SmallCharacter());
  EvaluatedFrame frame;
  Pose pose = TrainingTrack().pose(0);
  const auto expect_refused = [&](const Pose& bad, const std::vector<double>& scales,
                                  const char* word) {
    EXPECT_THAT(evaluator.Evaluate({&bad}, scales, &frame),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(word)));
  };
  Pose few = pose;
  few.rotations.pop_back();
  expect_refused(few, {}, "17 rotations");
  Pose not_finite = pose;
  not_finite.root_position.x() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(not_finite, {}, "root position");
  Pose zero = pose;
  zero.rotations[3].coeffs().setZero();
  expect_refused(zero, {}, "joint 3");
  expect_refused(pose, {1, 2}, "bone scales");
  expect_refused(pose, std::vector<double>(kNumHumanJoints, 1e6), "bone scale");
  EXPECT_THAT(evaluator.Evaluate({}, {}, &frame),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("at least one pose")));
}

}  // namespace
}  // namespace pleat
