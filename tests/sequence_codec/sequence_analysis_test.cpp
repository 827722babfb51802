#include "sequence_analysis.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "sequence_codec/compressed_clip.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

Eigen::Matrix3d RotationOf(const SegmentAnalysis& segment, int t) {
  const auto q = segment.rigid.col(t);
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

// rest + the motion that is left, without the rigid one.
Eigen::Matrix3Xd Aligned(const MeshSequence& sequence, const SegmentAnalysis& segment, int t) {
  return RotationOf(segment, t).transpose() *
         (sequence.FrameAsDouble(segment.first_frame + t).colwise() -
          Eigen::Vector3d(segment.rigid.col(t).tail<3>()));
}

TEST(SequenceAnalysisTest, ARigidMotionIsAllRigid) {
  const TestMesh torus = MakeTorus(8, 6, 5);
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < 40; ++t) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(.17 * t, Eigen::Vector3d(1, 3, -2).normalized()).toRotationMatrix();
    frames.push_back(
        ((turn * torus.positions.cast<double>()).colwise() + Eigen::Vector3d(.1 * t, 2, 0))
            .cast<float>());
  }
  const MeshSequence sequence = MeshSequence::Create(torus.topology, frames).value();
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceAnalysis analysis, AnalyzeSequence(sequence, 1, {}));
  ASSERT_EQ(analysis.segments.size(), 1u);
  EXPECT_LT(analysis.segments[0].singular_values[0], 1e-4);
  EXPECT_LT(analysis.rest.rowwise().mean().norm(), 1e-5f);  // centered
  for (int t = 0; t < 40; ++t) {
    EXPECT_LT((Aligned(sequence, analysis.segments[0], t) - analysis.rest.cast<double>())
                  .cwiseAbs()
                  .maxCoeff(),
              1e-5)
        << t;
  }
}

TEST(SequenceAnalysisTest, QuaternionsAreUnitAndNeverJumpInSign) {
  const MeshSequence sequence = MakeWavingTorus(8, 6, 130);  // turns more than once
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceAnalysis analysis, AnalyzeSequence(sequence, 1, {}));
  const TrajectoryMatrix& rigid = analysis.segments[0].rigid;
  for (int t = 0; t < 130; ++t) {
    EXPECT_NEAR(rigid.col(t).head<4>().norm(), 1, 1e-9);
    if (t == 0) continue;
    EXPECT_GT(rigid.col(t).head<4>().dot(rigid.col(t - 1).head<4>()), .9) << t;
  }
}

TEST(SequenceAnalysisTest, TrajectoriesAreOrthonormalAndHoldTheWholeMotion) {
  const MeshSequence sequence = MakeWavingTorus(8, 6, 24);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceAnalysis analysis, AnalyzeSequence(sequence, 1, {}));
  const SegmentAnalysis& segment = analysis.segments[0];
  const Eigen::MatrixXd gram = segment.trajectories * segment.trajectories.transpose();
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(24, 24)).cwiseAbs().maxCoeff(), 1e-9);
  double energy = 0;
  for (int t = 0; t < 24; ++t) {
    energy += (Aligned(sequence, segment, t) - analysis.rest.cast<double>()).squaredNorm();
  }
  EXPECT_NEAR(segment.singular_values.squaredNorm(), energy, 1e-3 * energy);
  for (int k = 1; k < 24; ++k) {
    EXPECT_LE(segment.singular_values[k], segment.singular_values[k - 1]);
  }
  EXPECT_GE(segment.singular_values[23], 0);
  // One wave with a moving phase: two components hold nearly all of it, noise the rest.
  EXPECT_GT(segment.singular_values[1], 10 * segment.singular_values[4]);
}

TEST(SequenceAnalysisTest, LongSequencesAreCutIntoEvenSegments) {
  const MeshSequence sequence = MakeWavingTorus(3, 3, 1030);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceAnalysis analysis, AnalyzeSequence(sequence, 2, {}));
  ASSERT_EQ(analysis.segments.size(), 3u);
  int next = 0;
  for (const SegmentAnalysis& segment : analysis.segments) {
    EXPECT_EQ(segment.first_frame, next);
    EXPECT_NEAR(segment.num_frames, 1030 / 3, 1);
    EXPECT_EQ(segment.rigid.cols(), segment.num_frames);
    next += segment.num_frames;
  }
  EXPECT_EQ(next, 1030);
}

TEST(SequenceAnalysisTest, ResultsDoNotDependOnThreads) {
  const MeshSequence sequence = MakeWavingTorus(8, 6, 40);
  const SequenceAnalysis one = AnalyzeSequence(sequence, 1, {}).value();
  const SequenceAnalysis four = AnalyzeSequence(sequence, 4, {}).value();
  EXPECT_EQ(one.rest, four.rest);
  EXPECT_EQ(one.segments[0].rigid, four.segments[0].rigid);
  EXPECT_EQ(one.segments[0].trajectories, four.segments[0].trajectories);
  EXPECT_EQ(one.segments[0].singular_values, four.segments[0].singular_values);
}

// A flat mesh and one point have no unique rotation: the fit may fail, the analysis may not.
TEST(SequenceAnalysisTest, ShapesWithoutExtentAreAnalyzed) {
  const Topology topology = Topology::Create(2, {}, {}).value();
  const MeshSequence sequence =
      MeshSequence::Create(topology, {Eigen::Matrix3Xf::Ones(3, 2), Eigen::Matrix3Xf::Zero(3, 2)})
          .value();
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceAnalysis analysis, AnalyzeSequence(sequence, 1, {}));
  EXPECT_TRUE(analysis.rest.isZero());
  EXPECT_TRUE(analysis.segments[0].rigid.allFinite());
  EXPECT_EQ(Eigen::Vector3d(analysis.segments[0].rigid.col(0).tail<3>()), Eigen::Vector3d::Ones());
}

}  // namespace
}  // namespace pleat
