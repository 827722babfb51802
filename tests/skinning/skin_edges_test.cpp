#include "pleat/skinning/skin_edges.h"

#include <gtest/gtest.h>

#include "support/allocation_counter.h"
#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class SkinEdgesTest : public testing::Test {
 protected:
  SkinEdgesTest() {
    for (int v = 0; v < figure_.rig.weights.num_vertices(); v += 5) {
      parameters_.vertices.push_back(v);
    }
    for (int p = 0; p + 2 < static_cast<int>(parameters_.vertices.size()); ++p) {
      parameters_.edges.push_back({p, p + 2});
      parameters_.lengths.push_back(.01f * static_cast<float>(1 + p));
    }
    pose_ = Pose::Rest(figure_.rig.skeleton);
    for (size_t b = 1; b < pose_.rotations.size(); ++b) {
      pose_.rotations[b] = Eigen::AngleAxisd(.1 * static_cast<double>(b % 5),
                                             Eigen::Vector3d(1, .3, -.2).normalized());
    }
  }
  Eigen::VectorXf Compute(const Pose& pose) const {
    const SkinEdges edges = SkinEdges::Create(figure_.rig, parameters_).value();
    SkinEdges::Workspace workspace;
    BoneTransforms transforms;
    ComputeBoneTransforms(figure_.rig.skeleton, pose, {}, &transforms);
    Eigen::VectorXf values(edges.num_values());
    edges.Compute(transforms, &workspace, values);
    return values;
  }

  const SkinnedFigure figure_ = MakeSkinnedFigure({.num_rings = 4, .num_sides = 5});
  SkinEdgesParameters parameters_;
  Pose pose_;
};

TEST_F(SkinEdgesTest, AreTheSkinnedEdgesInTheAxesOfTheirFirstPoint) {
  const Eigen::VectorXf values = Compute(pose_);
  BoneTransforms transforms;
  ComputeBoneTransforms(figure_.rig.skeleton, pose_, {}, &transforms);
  Eigen::Matrix3Xd skinned;
  SkinVertices(figure_.rig.weights, figure_.rig.rest_positions, transforms, &skinned);
  std::vector<Eigen::Quaterniond> rotations;
  BlendRotations(figure_.rig.weights, parameters_.vertices, transforms, &rotations);
  for (size_t e = 0; e < parameters_.edges.size(); ++e) {
    const auto [first, second] = parameters_.edges[e];
    const Eigen::Vector3d along =
        skinned.col(parameters_.vertices[second]) - skinned.col(parameters_.vertices[first]);
    const Eigen::Vector3d expected = rotations[first].conjugate() * along / parameters_.lengths[e];
    EXPECT_LT(
        (values.segment<3>(3 * static_cast<Eigen::Index>(e)).cast<double>() - expected).norm(),
        1e-4);
  }
}

TEST_F(SkinEdgesTest, DoNotFeelWhereTheBodyIsAndWhereItFaces) {
  const Eigen::VectorXf here = Compute(pose_);
  pose_.root_position += Eigen::Vector3d(3, -1, 2);
  pose_.rotations[0] = Eigen::AngleAxisd(2, Eigen::Vector3d(.2, 1, .4).normalized());
  EXPECT_LT((Compute(pose_) - here).cwiseAbs().maxCoeff(), 1e-3 * here.cwiseAbs().maxCoeff());
  pose_.rotations[5] = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX());
  EXPECT_GT((Compute(pose_) - here).cwiseAbs().maxCoeff(), .05);
}

TEST_F(SkinEdgesTest, ComputingDoesNotAllocate) {
  if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  const SkinEdges edges = SkinEdges::Create(figure_.rig, parameters_).value();
  SkinEdges::Workspace workspace;
  BoneTransforms transforms;
  ComputeBoneTransforms(figure_.rig.skeleton, pose_, {}, &transforms);
  Eigen::VectorXf values(edges.num_values());
  edges.Compute(transforms, &workspace, values);
  const long before = NumAllocations();
  edges.Compute(transforms, &workspace, values);
  EXPECT_EQ(NumAllocations(), before);
}

TEST_F(SkinEdgesTest, RefusesWhatIsOutOfRange) {
  const auto refused = [&](auto change, const std::string& words) {
    SkinEdgesParameters p = parameters_;
    change(p);
    EXPECT_THAT(SkinEdges::Create(figure_.rig, p),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  refused([](auto& p) { p.vertices[1] = -1; }, "vertex -1");
  refused([&](auto& p) { p.vertices[1] = figure_.rig.weights.num_vertices(); }, "is not in");
  refused([](auto& p) { p.lengths.pop_back(); }, "lengths for");
  refused([](auto& p) { p.lengths[0] = 0; }, "length 0");
  refused([](auto& p) { p.lengths[0] = std::numeric_limits<float>::infinity(); }, "edge 0");
  refused([](auto& p) { p.edges[3] = {2, 2}; }, "edge 3");
  refused([](auto& p) { p.edges[3] = {-1, 2}; }, "edge 3");
  refused([](auto& p) { p.edges[3][1] = static_cast<int>(p.vertices.size()); }, "edge 3");
}

}  // namespace
}  // namespace pleat
