#include "pleat/fitting/moments.h"

#include <gtest/gtest.h>

#include "pleat/fitting/pose_energy.h"
#include "support/skinned_figure.h"

namespace pleat {
namespace {

// g_ia of every vertex by its definition (3J x V), with weights normalized in double precision.
Eigen::MatrixXd ChainCoefficients(const Rig& rig) {
  const Skeleton& skeleton = rig.skeleton;
  const int num_joints = skeleton.num_joints();
  Eigen::MatrixXd weights = rig.weights.ToDense();
  weights.array().colwise() /= weights.rowwise().sum().array().eval();
  Eigen::MatrixXd g = Eigen::MatrixXd::Zero(3 * num_joints, rig.rest_positions.cols());
  for (int b = 1; b < num_joints; ++b) {
    const Eigen::Vector3d pivot = skeleton.rest_position(skeleton.parent(b));
    for (Eigen::Index v = 0; v < g.cols(); ++v) {
      g.block<3, 1>(3 * b, v) += weights(v, b) * (rig.rest_positions.col(v) - pivot);
      for (int a = skeleton.parent(b); a > 0; a = skeleton.parent(a)) {
        g.block<3, 1>(3 * a, v) += weights(v, b) * (skeleton.rest_position(a) -
                                                    skeleton.rest_position(skeleton.parent(a)));
      }
    }
  }
  return g;
}

TEST(MomentsTest, ChainMomentsAreSumsOverVertices) {
  const SkinnedFigure figure = MakeSkinnedFigure();
  const RigMoments moments = ComputeRigMoments(figure.rig);
  const ChainMoments chain = ComputeChainMoments(moments, figure.rig.skeleton);
  const Eigen::MatrixXd g = ChainCoefficients(figure.rig);
  EXPECT_LT((chain.gram - g * g.transpose()).cwiseAbs().maxCoeff(), 1e-9);
  for (int a = 0; a < chain.num_joints; ++a) {
    EXPECT_LT((chain.sums.col(a) - g.middleRows<3>(3 * a).rowwise().sum()).norm(), 1e-9);
  }

  const PoseTrack track = MakeSmoothPoses(figure.rig.skeleton, 3, 1);
  const MeshSequence sequence = MakeSkinnedSequence(figure, track);
  const FrameMoments frame = ComputeFrameMoments(figure.rig, moments, sequence.frame(2));
  const Eigen::Matrix3Xd y = sequence.FrameAsDouble(2).colwise() - frame.center;
  EXPECT_NEAR(frame.sum_squares, y.squaredNorm(), 1e-9);
  EXPECT_LT((ComputeChainCross(moments, frame, figure.rig.skeleton) - g * y.transpose())
                .cwiseAbs()
                .maxCoeff(),
            1e-9);
}

// A fit weight of two counts like a vertex that is there twice.
TEST(MomentsTest, FitWeightsAreRepetitions) {
  const SkinnedFigure figure = MakeSkinnedFigure({.num_rings = 3, .num_sides = 4});
  const PoseTrack track = MakeSmoothPoses(figure.rig.skeleton, 3, 1);
  const Eigen::Matrix3Xf once = MakeSkinnedSequence(figure, track).frame(2);
  const Eigen::Index count = once.cols();
  std::vector<int> repeated;
  Rig weighted = figure.rig;
  weighted.fit_weights.resize(count);
  for (int v = 0; v < count; ++v) {
    const int times = 1 + v % 3;
    weighted.fit_weights[v] = static_cast<float>(times);
    repeated.insert(repeated.end(), times, v);
  }
  Rig larger = figure.rig;
  larger.rest_positions = figure.rig.rest_positions(Eigen::all, repeated);
  std::vector<VertexInfluences> influences;
  for (const int v : repeated) influences.push_back(figure.rig.weights.vertex(v));
  larger.weights = SkinWeights::Create(18, influences).value();
  const Eigen::Matrix3Xf frame = once(Eigen::all, repeated);

  const RigMoments a = ComputeRigMoments(weighted), b = ComputeRigMoments(larger);
  EXPECT_EQ(a.num_vertices, b.num_vertices);
  // The centers of the rest meshes differ, which the chain takes out again.
  const ChainMoments chain_a = ComputeChainMoments(a, figure.rig.skeleton);
  const ChainMoments chain_b = ComputeChainMoments(b, figure.rig.skeleton);
  EXPECT_LT((chain_a.gram - chain_b.gram).norm(), 1e-9 * chain_b.gram.norm());
  const FrameMoments frame_a = ComputeFrameMoments(weighted, a, once);
  const FrameMoments frame_b = ComputeFrameMoments(larger, b, frame);
  EXPECT_LT((frame_a.center - frame_b.center).norm(), 1e-9);
  EXPECT_NEAR(frame_a.sum_squares, frame_b.sum_squares, 1e-9 * frame_b.sum_squares);
  EXPECT_LT((ComputeChainCross(a, frame_a, figure.rig.skeleton) -
             ComputeChainCross(b, frame_b, figure.rig.skeleton))
                .norm(),
            1e-8);
}

// Only what hangs together counts: neither the place of the rest mesh nor the order of vertices.
TEST(MomentsTest, PlaceAndOrderOfTheRestMeshDoNotMatter) {
  const SkinnedFigure figure = MakeSkinnedFigure({.num_rings = 3, .num_sides = 4});
  const auto gram = [](const Rig& rig) {
    return ComputeChainMoments(ComputeRigMoments(rig), rig.skeleton).gram;
  };
  const Eigen::MatrixXd expected = gram(figure.rig);
  Rig moved = figure.rig;
  const Eigen::Vector3d shift(40, -7, 12);
  moved.rest_positions.colwise() += shift;
  moved.skeleton =
      moved.skeleton.WithRestPositions(moved.skeleton.RestPositions().colwise() + shift);
  EXPECT_LT((gram(moved) - expected).norm(), 1e-9 * expected.norm());
  Rig reversed = figure.rig;
  reversed.rest_positions = figure.rig.rest_positions.rowwise().reverse();
  reversed.weights =
      SkinWeights::FromDense(figure.rig.weights.ToDense().colwise().reverse()).value();
  EXPECT_LT((gram(reversed) - expected).norm(), 1e-6 * expected.norm());  // float weights
}

// The energy of one frame (3 x V) as a function of the pose.
class FrameEnergy {
 public:
  FrameEnergy(const Rig& rig, const Eigen::Matrix3Xf& positions)
      : skeleton_(rig.skeleton),
        moments_(ComputeRigMoments(rig)),
        chain_(ComputeChainMoments(moments_, skeleton_)),
        frame_(ComputeFrameMoments(rig, moments_, positions)),
        energy_(chain_, skeleton_, 0) {
    energy_.SetFrame(ComputeChainCross(moments_, frame_, skeleton_), frame_.sum_squares);
  }
  double At(const Pose& pose) const {
    return energy_.DataValue(ToChainPose(skeleton_, pose, frame_.center));
  }

 private:
  const Skeleton& skeleton_;
  const RigMoments moments_;
  const ChainMoments chain_;
  const FrameMoments frame_;
  PoseEnergy energy_;
};

TEST(MomentsTest, EnergyIsTheSquaredDistanceOfSkinnedVertices) {
  const SkinnedFigure figure = MakeSkinnedFigure();
  const Skeleton& skeleton = figure.rig.skeleton;
  const PoseTrack track = MakeSmoothPoses(skeleton, 9, 3);
  const MeshSequence sequence = MakeSkinnedSequence(figure, track);
  const FrameEnergy energy(figure.rig, sequence.frame(8));
  const double measured = (sequence.FrameAsDouble(0) - sequence.FrameAsDouble(8)).squaredNorm();
  EXPECT_NEAR(energy.At(track.pose(0)), measured, 1e-5 * measured);
  EXPECT_NEAR(energy.At(track.pose(8)), 0, 1e-9);
}

TEST(MomentsTest, FarFromTheOriginTheEnergyKeepsItsDigits) {
  SkinnedFigure figure = MakeSkinnedFigure();
  const Skeleton& skeleton = figure.rig.skeleton;
  PoseTrack::Parts parts = MakeSmoothPoses(skeleton, 2, 3).Take();
  for (Pose& pose : parts.poses) pose.root_position += Eigen::Vector3d(512, 0, -256);
  const PoseTrack track = PoseTrack::FromValid(std::move(parts));
  const MeshSequence sequence = MakeSkinnedSequence(figure, track);
  const double value = FrameEnergy(figure.rig, sequence.frame(1)).At(track.pose(1));
  // float32 at 512 m resolves 31 micrometers; the weights' float sums add about as much.
  EXPECT_LT(std::sqrt(std::abs(value) / sequence.num_vertices()), 1e-4);
}

}  // namespace
}  // namespace pleat
