#include "pleat/skinning/cut_influences.h"

#include <cmath>
#include <numbers>

#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(CutInfluencesTest, TheStrongestStayAndAddUpToOne) {
  const SkinWeights weights = *SkinWeights::Create(
      5, {{{1, 2, 3, 4}, {.4f, .3f, .2f, .1f}}, {{3, 1, 0, 0}, {.75f, .25f, 0, 0}}});
  const SkinWeights two = CutInfluences(weights, 2);
  EXPECT_EQ(two.vertex(0).bones[0], 1);
  EXPECT_EQ(two.vertex(0).bones[1], 2);
  EXPECT_FLOAT_EQ(two.vertex(0).weights[0], .4f / .7f);
  EXPECT_FLOAT_EQ(two.vertex(0).weights[1], .3f / .7f);
  EXPECT_EQ(two.vertex(0).weights[2], 0);
  EXPECT_EQ(two.vertex(1).weights, weights.vertex(1).weights);
  const SkinWeights all = CutInfluences(weights, kMaxInfluences);
  EXPECT_EQ(all.vertex(0).weights, weights.vertex(0).weights);
  EXPECT_EQ(CutInfluences(weights, 1).vertex(0).weights[0], 1);
}

TEST(CutInfluencesTest, TheErrorIsTheWayOfTheVertices) {
  // One vertex on the second bone, which a quarter of the first bone would hold back.
  Rig rig;
  rig.skeleton =
      *Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b", 0, {1, 0, 0}}, {"c", 1, {2, 0, 0}}});
  rig.rest_positions = Eigen::Vector3d(2, 0, 0);
  rig.weights = *SkinWeights::Create(3, {{{2, 1, 0, 0}, {.75f, .25f, 0, 0}}});
  PoseTrack::Parts parts;
  for (const double angle : {0., std::numbers::pi / 2}) {
    Pose pose = Pose::Rest(rig.skeleton);
    pose.rotations[2] = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ());
    parts.poses.push_back(pose);
  }
  const PoseTrack track = PoseTrack::FromValid(std::move(parts));
  const InfluenceCutError error = MeasureInfluenceCut(rig, CutInfluences(rig.weights, 1), track);
  // Cut it goes to (1, 1, 0), else to .75 (1, 1, 0) + .25 (2, 0, 0).
  EXPECT_NEAR(error.max_m, .25 * std::sqrt(2), 1e-12);
  EXPECT_NEAR(error.rms_m, .25, 1e-12);
  EXPECT_EQ(error.num_vertices, 1);
  EXPECT_EQ(error.worst_frame, 1);
  EXPECT_EQ(MeasureInfluenceCut(rig, rig.weights, track).max_m, 0);
}

TEST(CutInfluencesTest, MoreInfluencesAreNearer) {
  const SkinnedFigure figure = MakeSkinnedFigure();
  const PoseTrack track = MakeSmoothPoses(figure.rig.skeleton, 10, 5, .9);
  double last = 0;
  for (int count = kMaxInfluences; count >= 1; --count) {
    const InfluenceCutError error =
        MeasureInfluenceCut(figure.rig, CutInfluences(figure.rig.weights, count), track);
    EXPECT_GE(error.rms_m, last);
    last = error.rms_m;
  }
  EXPECT_GT(last, .001);
}

}  // namespace
}  // namespace pleat
