#include "pleat/fitting/fit_weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pleat/base/random.h"
#include "pleat/fitting/pose_fit.h"
#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

// A figure of which one arm is dragged by something that is not its skeleton.
class FitWeightsTest : public testing::Test {
 protected:
  bool IsDragged(int v) const {
    return figure_.rig.weights.vertex(v).bones[0] == figure_.rig.skeleton.FindJoint("leftHand");
  }
  MeshSequence Dragged() const {
    std::vector<Eigen::Matrix3Xf> frames;
    const MeshSequence clean = MakeSkinnedSequence(figure_, track_);
    Random random(4);
    for (int t = 0; t < clean.num_frames(); ++t) {
      Eigen::Matrix3Xf frame = clean.frame(t);
      const Eigen::Vector3f drag(.1f * std::sin(.7f * t), .1f * std::cos(.3f * t), .05f);
      for (int v = 0; v < clean.num_vertices(); ++v) {
        if (IsDragged(v)) frame.col(v) += drag;
      }
      frames.push_back(frame);
    }
    return MeshSequence::Create(figure_.topology, std::move(frames), {.name = "dragged"}).value();
  }

  const SkinnedFigure figure_ = MakeSkinnedFigure();
  const PoseTrack track_ = MakeSmoothPoses(figure_.rig.skeleton, 30, 2);
};

TEST_F(FitWeightsTest, WhatDoesNotFollowItsBonesCountsLess) {
  const Eigen::VectorXf weights = ComputeFitWeights(Dragged(), figure_.rig, track_, 1);
  ASSERT_EQ(weights.size(), figure_.rig.weights.num_vertices());
  EXPECT_NEAR(weights.mean(), 1, 1e-5);
  EXPECT_EQ(ComputeFitWeights(Dragged(), figure_.rig, track_, 3), weights);
  float most_dragged = 0, least_other = 10;
  for (int v = 0; v < weights.size(); ++v) {
    if (IsDragged(v)) {
      most_dragged = std::max(most_dragged, weights[v]);
    } else {
      least_other = std::min(least_other, weights[v]);
    }
  }
  EXPECT_LT(most_dragged, .5f * least_other);
}

TEST_F(FitWeightsTest, PosesComeNearerToTheTruth) {
  const MeshSequence sequence = Dragged();
  const auto error = [&](const Rig& rig) {
    const PoseTrack found = FitPoses(sequence, rig, {.num_threads = 1}, nullptr).value();
    double sum = 0;
    for (int t = 0; t < track_.num_frames(); ++t) {
      BoneTransforms a, b;
      ComputeBoneTransforms(rig.skeleton, found.pose(t), {}, &a);
      ComputeBoneTransforms(rig.skeleton, track_.pose(t), {}, &b);
      sum += (a.joint_positions - b.joint_positions).norm();
    }
    return sum;
  };
  Rig weighted = figure_.rig;
  weighted.fit_weights = ComputeFitWeights(sequence, figure_.rig, track_, 1);
  EXPECT_LT(error(weighted), .95 * error(figure_.rig));
}

TEST_F(FitWeightsTest, APerfectFitNeedsNone) {
  Rig exact = figure_.rig;
  std::vector<VertexInfluences> rigid = figure_.rig.weights.influences();
  for (VertexInfluences& vertex : rigid) vertex = {{vertex.bones[0]}, {1}};
  exact.weights = SkinWeights::Create(18, rigid).value();
  exact.rest_positions = figure_.rig.rest_positions.cast<float>().cast<double>();
  const MeshSequence still =
      MeshSequence::Create(figure_.topology, {exact.rest_positions.cast<float>()}).value();
  const PoseTrack rest = PoseTrack::FromValid({.poses = {Pose::Rest(figure_.rig.skeleton)}});
  EXPECT_EQ(ComputeFitWeights(still, exact, rest, 1).size(), 0);
}

}  // namespace
}  // namespace pleat
