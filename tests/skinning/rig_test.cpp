#include "pleat/skinning/rig.h"

#include <gtest/gtest.h>

#include <numeric>

#include "pleat/math/rotations.h"
#include "support/skinned_figure.h"

namespace pleat {
namespace {

class RigTest : public ::testing::Test {
 protected:
  RigTest() : figure_(MakeSkinnedFigure()), all_(figure_.topology.num_vertices()) {
    std::iota(all_.begin(), all_.end(), 0);
  }
  Eigen::Matrix3Xd Skin(const Pose& pose, BoneTransforms* transforms) const {
    ComputeBoneTransforms(figure_.rig.skeleton, pose, {}, transforms);
    Eigen::Matrix3Xd positions;
    SkinVertices(figure_.rig.weights, figure_.rig.rest_positions, *transforms, &positions);
    return positions;
  }
  SkinnedFigure figure_;
  std::vector<int> all_;
  BoneTransforms transforms_;
};

TEST_F(RigTest, RestPoseIsTheRestMesh) {
  const Eigen::Matrix3Xd skinned = Skin(Pose::Rest(figure_.rig.skeleton), &transforms_);
  EXPECT_LT((skinned - figure_.rig.rest_positions).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(RigTest, AgreesWithTheDenseFormula) {
  const Pose pose = MakeSmoothPoses(figure_.rig.skeleton, 6, 4).pose(5);
  const Eigen::Matrix3Xd skinned = Skin(pose, &transforms_);
  const Eigen::MatrixXd weights = figure_.rig.weights.ToDense();
  Eigen::Matrix3Xd expected = Eigen::Matrix3Xd::Zero(3, skinned.cols());
  for (int b = 1; b < 18; ++b) {
    const Eigen::Matrix3Xd moved =
        (transforms_.linear[b] * figure_.rig.rest_positions).colwise() + transforms_.translation[b];
    expected += moved * weights.col(b).asDiagonal();
  }
  EXPECT_LT((skinned - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(RigTest, RigidMotionOfTheBodyMovesTheMeshRigidly) {
  Pose pose = MakeSmoothPoses(figure_.rig.skeleton, 6, 4).pose(5);
  BoneTransforms before_transforms;
  const Eigen::Matrix3Xd before = Skin(pose, &before_transforms);
  const Eigen::Quaterniond turn = QuaternionFromExponentialMap({1, -0.5, 2});
  const Eigen::Vector3d shift(1, 2, 3);
  pose.root_position = turn * pose.root_position + shift;
  pose.rotations[0] = turn * pose.rotations[0];
  const Eigen::Matrix3Xd after = Skin(pose, &transforms_);
  const Eigen::Matrix3Xd expected = (turn.toRotationMatrix() * before).colwise() + shift;
  EXPECT_LT((after - expected).cwiseAbs().maxCoeff(), 1e-5);  // float weights sum to 1 +- 1e-7

  std::vector<Eigen::Quaterniond> a, b;
  BlendRotations(figure_.rig.weights, all_, before_transforms, &a);
  BlendRotations(figure_.rig.weights, all_, transforms_, &b);
  for (size_t v = 0; v < all_.size(); ++v) EXPECT_LT((turn * a[v]).angularDistance(b[v]), 1e-6);
}

TEST_F(RigTest, BlendRotationOfOneBoneIsItsRotation) {
  const Pose pose = MakeSmoothPoses(figure_.rig.skeleton, 6, 4, 1.2).pose(5);
  Skin(pose, &transforms_);
  std::vector<VertexInfluences> influences(2);
  influences[0] = {{kLeftHand}, {1}};
  influences[1] = {{kChest, kHead}, {.5f, .5f}};
  const SkinWeights weights = *SkinWeights::Create(18, influences);
  std::vector<Eigen::Quaterniond> rotations;
  BlendRotations(weights, {1, 0}, transforms_, &rotations);
  ASSERT_EQ(rotations.size(), 2u);
  EXPECT_LT(
      (rotations[1].toRotationMatrix() - transforms_.rotation[kLeftHand]).cwiseAbs().maxCoeff(),
      1e-9);
  const Eigen::Quaterniond half = Eigen::Quaterniond(transforms_.rotation[kChest])
                                      .slerp(0.5, Eigen::Quaterniond(transforms_.rotation[kHead]));
  EXPECT_LT(rotations[0].angularDistance(half), 1e-6);
}

TEST_F(RigTest, BlendRotationsDoNotDependOnQuaternionSigns) {
  // Two bones turned by 170 and 190 degrees: their quaternions come out with opposite signs.
  BoneTransforms transforms;
  transforms.rotation.assign(3, Eigen::Matrix3d::Identity());
  transforms.rotation[1] =
      QuaternionFromExponentialMap({0, M_PI * 170 / 180, 0}).toRotationMatrix();
  transforms.rotation[2] =
      QuaternionFromExponentialMap({0, M_PI * 190 / 180, 0}).toRotationMatrix();
  const SkinWeights weights = *SkinWeights::Create(3, {{{1, 2}, {.5f, .5f}}});
  std::vector<Eigen::Quaterniond> rotations;
  BlendRotations(weights, {0}, transforms, &rotations);
  EXPECT_LT(rotations[0].angularDistance(QuaternionFromExponentialMap({0, M_PI, 0})), 1e-6);
}

TEST_F(RigTest, NoAllocationOnceWarm) {
  const Pose pose = Pose::Rest(figure_.rig.skeleton);
  Eigen::Matrix3Xd positions = Skin(pose, &transforms_);
  const double* memory = positions.data();
  SkinVertices(figure_.rig.weights, figure_.rig.rest_positions, transforms_, &positions);
  EXPECT_EQ(positions.data(), memory);
}

// Positions are linear in the rest shape: that of a mean is the mean.
TEST_F(RigTest, SkinningIsLinearInTheRestShape) {
  Skin(MakeSmoothPoses(figure_.rig.skeleton, 6, 4).pose(5), &transforms_);
  const Eigen::Matrix3Xd a = figure_.rig.rest_positions;
  const Eigen::Matrix3Xd b = a + .1 * Eigen::Matrix3Xd::Random(3, a.cols());
  const auto skin = [&](const Eigen::Matrix3Xd& rest) {
    Eigen::Matrix3Xd positions;
    SkinVertices(figure_.rig.weights, rest, transforms_, &positions);
    return positions;
  };
  const Eigen::Matrix3Xd mean = .25 * skin(a) + .75 * skin(b);
  EXPECT_LT((skin(.25 * a + .75 * b) - mean).cwiseAbs().maxCoeff(), 1e-12);
}

// The blend of rigid motions stays within the box of what each bone alone would do.
TEST_F(RigTest, AVertexLiesBetweenTheWaysOfItsBones) {
  const Eigen::Matrix3Xd skinned =
      Skin(MakeSmoothPoses(figure_.rig.skeleton, 6, 4, 1.2).pose(5), &transforms_);
  for (int v = 0; v < skinned.cols(); ++v) {
    const VertexInfluences& influences = figure_.rig.weights.vertex(v);
    Eigen::AlignedBox3d box;
    for (int k = 0; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
      const int b = influences.bones[k];
      box.extend(Eigen::Vector3d(transforms_.linear[b] * figure_.rig.rest_positions.col(v) +
                                 transforms_.translation[b]));
    }
    // Float weights add up to 1 within rounding.
    EXPECT_LT(box.exteriorDistance(Eigen::Vector3d(skinned.col(v))), 1e-6) << v;
  }
}

// d position / d angle of the bone that turns = axis x (position - pivot), by central differences.
TEST_F(RigTest, TheDerivativeInABonesAngleIsTheLeverArm) {
  const Skeleton& skeleton = figure_.rig.skeleton;
  const double step = 1e-6;
  std::vector<VertexInfluences> rigid(all_.size());
  for (auto& vertex : rigid) vertex = {{kLeftHand}, {1}};
  figure_.rig.weights = SkinWeights::Create(18, rigid).value();
  const Pose pose = MakeSmoothPoses(skeleton, 6, 4).pose(5);
  BoneTransforms here;
  const Eigen::Matrix3Xd positions = Skin(pose, &here);
  // Every bone on the way from the root moves the hand; each turns about its parent joint.
  for (int bone = kLeftHand; bone > 0; bone = skeleton.parent(bone)) {
    const int parent = skeleton.parent(bone);
    const Eigen::Vector3d axis = here.rotation[parent] * Eigen::Vector3d::UnitY();
    const Eigen::Vector3d pivot = here.joint_positions.col(parent);
    const auto turned = [&](double angle) {
      Pose other = pose;
      other.rotations[bone] =
          Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) * pose.rotations[bone];
      return Skin(other, &transforms_);
    };
    const Eigen::Matrix3Xd slope = (turned(step) - turned(-step)) / (2 * step);
    for (int v = 0; v < positions.cols(); v += 37) {
      const Eigen::Vector3d expected = axis.cross(Eigen::Vector3d(positions.col(v)) - pivot);
      EXPECT_LT((slope.col(v) - expected).norm(), 1e-8) << skeleton.joint(bone).name << " " << v;
    }
  }
}

TEST_F(RigTest, BlendRotationsAreUnitAndNearestToTheStrongest) {
  Skin(MakeSmoothPoses(figure_.rig.skeleton, 6, 4, 1.2).pose(5), &transforms_);
  std::vector<Eigen::Quaterniond> rotations;
  BlendRotations(figure_.rig.weights, all_, transforms_, &rotations);
  for (const int v : all_) {
    const VertexInfluences& influences = figure_.rig.weights.vertex(v);
    EXPECT_NEAR(rotations[v].norm(), 1, 1e-12);
    // Not farther from the strongest bone than the farthest of the others.
    const Eigen::Quaterniond strongest(transforms_.rotation[influences.bones[0]]);
    double farthest = 0;
    for (int k = 1; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
      farthest = std::max(
          farthest,
          strongest.angularDistance(Eigen::Quaterniond(transforms_.rotation[influences.bones[k]])));
    }
    EXPECT_LE(rotations[v].angularDistance(strongest), farthest + 1e-7) << v;
  }
}

}  // namespace
}  // namespace pleat
