#include "motion_segment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "pleat/base/random.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

constexpr MotionSteps kSteps{
    .field_m = 1e-3f, .rest_m = 1e-3f, .rotation = 1e-4f, .translation_m = 1e-3f};

TrajectoryMatrix SmoothRigidRows(int num_frames) {
  TrajectoryMatrix rows(7, num_frames);
  for (int t = 0; t < num_frames; ++t) {
    const Eigen::Quaterniond q(Eigen::AngleAxisd(.05 * t, Eigen::Vector3d(1, 2, -.5).normalized()));
    rows.col(t) << q.w(), q.x(), q.y(), q.z(), .02 * t, std::sin(.1 * t), -1;
  }
  return rows;
}

TEST(MotionSegmentTest, RigidMotionIsCodedWithinItsStepsAndDecodesToTheSameBits) {
  for (const int num_frames : {1, 15, 16, 17, 200}) {
    const TrajectoryMatrix truth = SmoothRigidRows(num_frames);
    TrajectoryMatrix rows = truth;
    MotionSegment segment, decoded;
    segment.num_frames = decoded.num_frames = num_frames;
    BinaryCoder encoder = BinaryCoder::ForEncoding();
    ASSERT_THAT(CodeRigidMotion(kSteps, &encoder, &rows, &segment), IsOk());
    for (int t = 0; t < num_frames; ++t) {
      const Eigen::Matrix3d rotation =
          Eigen::Quaterniond(truth(0, t), truth(1, t), truth(2, t), truth(3, t)).toRotationMatrix();
      EXPECT_LT((segment.rotations[t].cast<double>() - rotation).norm(), 2e-3) << t;
      EXPECT_LT((segment.translations[t].cast<double>() - truth.col(t).tail<3>()).norm(), 5e-3);
      EXPECT_LT(
          (segment.rotations[t] * segment.rotations[t].transpose() - Eigen::Matrix3f::Identity())
              .norm(),
          1e-5f);
    }
    const std::string bytes = encoder.Finish();
    BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
    TrajectoryMatrix read;
    ASSERT_THAT(CodeRigidMotion(kSteps, &decoder, &read, &decoded), IsOk());
    EXPECT_EQ(decoded.rotations, segment.rotations);
    EXPECT_EQ(decoded.translations, segment.translations);
    EXPECT_EQ(read, rows);
  }
}

// A decoder may meet quaternions of any length in damaged bytes, zero included.
TEST(MotionSegmentTest, QuaternionsOfAnyLengthGiveRotations) {
  TrajectoryMatrix rows = TrajectoryMatrix::Zero(7, 2);
  rows.col(1).head<4>() = 7 * Eigen::Vector4d(.5, .5, -.5, .5);
  MotionSegment segment;
  segment.num_frames = 2;
  BinaryCoder coder = BinaryCoder::ForEncoding();
  ASSERT_THAT(CodeRigidMotion({.field_m = 1, .rest_m = 1, .rotation = 1e-6f, .translation_m = 1},
                              &coder, &rows, &segment),
              IsOk());
  EXPECT_LT(
      (segment.rotations[1].cast<double>() - Eigen::Quaterniond(.5, .5, -.5, .5).toRotationMatrix())
          .norm(),
      1e-5);
  TrajectoryMatrix zero = TrajectoryMatrix::Zero(7, 2);
  ASSERT_THAT(CodeRigidMotion(kSteps, &coder, &zero, &segment), IsOk());
  EXPECT_EQ(segment.rotations[0], Eigen::Matrix3f::Identity());
}

TEST(MotionSegmentTest, WeightsAreUnitRowsPaddedToWholeGroups) {
  TrajectoryMatrix rows(3, 20);
  for (int t = 0; t < 20; ++t) rows.col(t) << std::sin(.3 * t), 5 * std::cos(.2 * t), 0;
  MotionSegment segment, decoded;
  segment.num_frames = decoded.num_frames = 20;
  segment.num_components = decoded.num_components = 3;
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  ASSERT_THAT(CodeWeights(kSteps, &encoder, &rows, &segment), IsOk());
  ASSERT_EQ(segment.weights.rows(), 3);
  ASSERT_EQ(segment.weights.cols(), 32);
  EXPECT_NEAR(segment.weights.row(0).norm(), 1, 1e-5);
  EXPECT_NEAR(segment.weights.row(1).norm(), 1, 1e-5);
  EXPECT_EQ(segment.weights.row(2).norm(), 0);  // nothing to scale
  EXPECT_TRUE(segment.weights.rightCols(12).isZero());
  const std::string bytes = encoder.Finish();
  BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
  TrajectoryMatrix read;
  ASSERT_THAT(CodeWeights(kSteps, &decoder, &read, &decoded), IsOk());
  EXPECT_EQ(decoded.weights, segment.weights);
}

MotionSegment RandomSegment(int num_vertices, int num_frames, int num_components) {
  MotionSegment segment;
  segment.num_frames = num_frames;
  segment.num_components = num_components;
  Random random(4);
  for (int t = 0; t < num_frames; ++t) {
    const Eigen::Vector4d q(random.Normal(), random.Normal(), random.Normal(), random.Normal());
    segment.rotations.push_back(
        Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix().cast<float>());
    segment.translations.emplace_back(static_cast<float>(random.Normal()), 1.f, -2.f);
  }
  segment.weights.setZero(num_components, segment.num_groups() * kGroupFrames);
  segment.fields.resize(num_vertices, 3 * num_components);
  for (float& x : segment.weights.reshaped()) x = static_cast<float>(random.Normal());
  for (float& x : segment.fields.reshaped()) x = static_cast<float>(random.Normal());
  return segment;
}

TEST(MotionSegmentTest, GroupsAreTheModelWrittenOut) {
  constexpr int kNumVertices = 13;
  const Eigen::Matrix3Xf rest = Eigen::Matrix3Xf::Random(3, kNumVertices);
  for (const int num_components : {0, 1, 4}) {
    const MotionSegment segment = RandomSegment(kNumVertices, 37, num_components);
    int next = 0;
    for (int group = 0; group < segment.num_groups(); ++group) {
      std::vector<Eigen::Matrix3Xf> frames;
      EvaluateGroup(rest, segment, group, &frames);
      for (const Eigen::Matrix3Xf& frame : frames) {
        for (int v = 0; v < kNumVertices; ++v) {
          Eigen::Vector3d x = rest.col(v).cast<double>();
          for (int k = 0; k < num_components; ++k) {
            x += double{segment.weights(k, next)} *
                 segment.fields.block<1, 3>(v, 3 * k).transpose().cast<double>();
          }
          x = segment.rotations[next].cast<double>() * x +
              segment.translations[next].cast<double>();
          EXPECT_LT((frame.col(v).cast<double>() - x).norm(), 1e-5) << next << " " << v;
        }
        ++next;
      }
    }
    EXPECT_EQ(next, 37);
  }
}

// A group must not depend on what stood in the frames before, nor on the other groups.
TEST(MotionSegmentTest, GroupsCanBeReadInAnyOrder) {
  const Eigen::Matrix3Xf rest = Eigen::Matrix3Xf::Random(3, 9);
  const MotionSegment segment = RandomSegment(9, 40, 3);
  std::vector<Eigen::Matrix3Xf> fresh, used;
  EvaluateGroup(rest, segment, 2, &fresh);
  for (const int group : {0, 1, 0, 2}) EvaluateGroup(rest, segment, group, &used);
  EXPECT_EQ(used, fresh);
  EXPECT_EQ(fresh.size(), 8u);
}

}  // namespace
}  // namespace pleat
