#include <gtest/gtest.h>

#include <cmath>

#include "body_mesh.h"
#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(SkirtBoneWeightsTest, SumToOneAndMirror) {
  for (double x = -.15; x <= .15; x += .01) {
    for (const double s : {0., .1, .3, .7, 1.}) {
      for (const double off_leg : {0., .5, 1.}) {
        const Eigen::VectorXd weights = SkirtBoneWeights(x, s, off_leg);
        EXPECT_NEAR(weights.sum(), 1, 1e-12);
        EXPECT_GE(weights.minCoeff(), 0);
        const Eigen::VectorXd mirrored = SkirtBoneWeights(-x, s, off_leg);
        for (int j = 0; j < kNumHumanJoints; ++j) {
          EXPECT_NEAR(weights[j], mirrored[HumanMirror()[j]], 1e-12) << x << " " << s << " " << j;
        }
      }
    }
  }
}

TEST(SkirtBoneWeightsTest, TheWaistFollowsTheSpineAndTheHemTheThighs) {
  const Eigen::VectorXd waist = SkirtBoneWeights(0, 0, 1), hem = SkirtBoneWeights(.15, 1, 0);
  EXPECT_NEAR(waist[kSpine], .6, 1e-12);
  EXPECT_EQ(hem[kSpine], 0);
  EXPECT_NEAR(hem[kLeftLowerLeg], 1, 1e-12);  // the bone that ends at the knee is the thigh
  EXPECT_LT(SkirtBoneWeights(.15, 1, 1)[kLeftLowerLeg], .5);  // off the leg only in part
}

class BodyWeightsTest : public testing::Test {
 protected:
  const CharacterShape shape_{1};
  const TriangleSoup mesh_ = BuildBodyMesh(shape_, 1500, {}).value();
  const SkinWeights weights_ = BuildBodyWeights(shape_, mesh_).value();
};

TEST_F(BodyWeightsTest, RowsAreConvexWithAtMostFourInfluences) {
  const Eigen::MatrixXd dense = weights_.ToDense();
  ASSERT_EQ(dense.rows(), static_cast<int>(mesh_.positions.size()));
  for (int v = 0; v < dense.rows(); ++v) {
    EXPECT_NEAR(dense.row(v).sum(), 1, 1e-6);  // float32
    EXPECT_GE(dense.row(v).minCoeff(), 0);
    EXPECT_LE((dense.row(v).array() > 0).count(), 4);
  }
}

TEST_F(BodyWeightsTest, EveryPartFollowsItsOwnBone) {
  const Eigen::MatrixXd dense = weights_.ToDense();
  const auto weight_near = [&](const Eigen::Vector3d& place, int bone) {
    int nearest = 0;
    for (size_t v = 0; v < mesh_.positions.size(); ++v) {
      if ((mesh_.positions[v] - place).norm() < (mesh_.positions[nearest] - place).norm()) {
        nearest = static_cast<int>(v);
      }
    }
    return dense(nearest, bone);
  };
  const Skeleton& skeleton = shape_.skeleton();
  const auto middle = [&](int bone) {
    return Eigen::Vector3d(
        (skeleton.rest_position(bone) + skeleton.rest_position(skeleton.parent(bone))) / 2);
  };
  for (const int bone :
       {kLeftLowerArm, kRightLowerArm, kLeftHand, kRightHand, kLeftFoot, kRightFoot}) {
    EXPECT_GT(weight_near(middle(bone), bone), .8) << skeleton.joint(bone).name;
  }
  EXPECT_GT(weight_near({0, .99, 0}, kHead), .9);
}

// No step between neighbors: skinning has no creases that are not there.
TEST_F(BodyWeightsTest, WeightsAreSmoothAlongEdges) {
  const Eigen::MatrixXd dense = weights_.ToDense();
  double sum = 0;
  int count = 0;
  for (const auto& t : mesh_.triangles) {
    for (int c = 0; c < 3; ++c, ++count) {
      sum += (dense.row(t[c]) - dense.row(t[(c + 1) % 3])).cwiseAbs().maxCoeff();
    }
  }
  EXPECT_LT(sum / count, .15);
}

}  // namespace
}  // namespace pleat
