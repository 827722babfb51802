// Bodies of many builds whose joints are known: what is found must follow the build, and must not
// depend on where the body stands, how large it is, or which side is which.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "pleat/rigging/auto_rig.h"
#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

AutoRigOptions CoarseOptions() {
  AutoRigOptions options;
  options.num_threads = 1;
  options.volume.resolution = 96;
  return options;
}

struct Build {
  const char* name;
  CapsuleFigureOptions figure;
};

class ProportionsTest : public testing::TestWithParam<Build> {};

INSTANTIATE_TEST_SUITE_P(
    Builds, ProportionsTest,
    testing::Values(Build{"Child", {.height_m = 1, .cell_m = .015}},
                    Build{"Giant", {.height_m = 3, .yaw_degrees = 180, .cell_m = .045}},
                    Build{"LongArms", {.arm_length = 1.2, .cell_m = .025}},
                    Build{"ShortArms", {.yaw_degrees = 270, .arm_length = .85, .cell_m = .025}},
                    Build{"LevelArms", {.arm_angle_degrees = 5, .cell_m = .025}},
                    Build{"LowArms", {.arm_angle_degrees = 65, .cell_m = .025}},
                    Build{"BentArms", {.elbow_degrees = 40, .cell_m = .025}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(ProportionsTest, JointsAreFoundInAnyBuild) {
  const CapsuleFigure figure = MakeCapsuleFigure(GetParam().figure);
  const double height = GetParam().figure.height_m;
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig,
                             AutoRig(MakeStillSequence(figure.mesh), CoarseOptions(), &summary));
  EXPECT_NEAR(std::remainder(summary.yaw_degrees - GetParam().figure.yaw_degrees, 360), 0, 1e-9);
  const Eigen::Matrix3Xd joints = rig.skeleton.RestPositions();
  for (int j = 0; j < kNumHumanJoints; ++j) {
    const double error = (joints - figure.joints).col(j).norm();
    EXPECT_LT(error, .075 * height) << HumanTemplate().joint(j).name;
  }
  EXPECT_LT((joints - figure.joints).colwise().norm().mean(), .035 * height);
  // The body is the same on both sides, so the skeleton must be, about its own middle.
  const double yaw = summary.yaw_degrees * EIGEN_PI / 180;
  const Eigen::Vector3d left(std::cos(yaw), 0, -std::sin(yaw));
  for (int j = 0; j < kNumHumanJoints; ++j) {
    const Eigen::Vector3d own = joints.col(j), other = joints.col(HumanMirror()[j]);
    const Eigen::Vector3d mirrored = other - 2 * left.dot(other) * left;
    EXPECT_LT((own - mirrored).norm(), .03 * height) << HumanTemplate().joint(j).name;
    if (HumanMirror()[j] > j) {
      EXPECT_GT(left.dot(own), left.dot(other));
    }
  }
}

TEST_P(ProportionsTest, WeightsAreLocalAndSumToOne) {
  const CapsuleFigure figure = MakeCapsuleFigure(GetParam().figure);
  const Skeleton skeleton = HumanTemplate().WithRestPositions(figure.joints);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SkinWeights weights,
      ComputeHeatWeights(MakeTopology(figure.mesh), figure.mesh.positions, skeleton));
  const Eigen::MatrixXd dense = weights.ToDense();
  EXPECT_EQ(dense.col(0).maxCoeff(), 0);  // the root has no bone
  EXPECT_GE(dense.minCoeff(), 0);
  EXPECT_LT((dense.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-5);
  for (int v = 0; v < dense.rows(); ++v) {
    EXPECT_LE((dense.row(v).array() > 0).count(), 4);
    const Eigen::Vector3d vertex = figure.mesh.positions.col(v);
    double nearest = 1e9;
    Eigen::VectorXd distances(kNumHumanJoints);
    for (int b = 1; b < kNumHumanJoints; ++b) {
      distances[b] = (ClosestPointOnSegment(vertex, figure.joints.col(skeleton.parent(b)),
                                            figure.joints.col(b)) -
                      vertex)
                         .norm();
      nearest = std::min(nearest, distances[b]);
    }
    for (int b = 1; b < kNumHumanJoints; ++b) {
      // A bone that is farther by a tenth of the body's height moves nothing here.
      if (distances[b] > nearest + .1 * GetParam().figure.height_m) {
        EXPECT_LT(dense(v, b), .15);
      }
    }
  }
}

// A figure with one arm level and the other low: which side is which can be seen.
TEST(MirroredBodyTest, LeftBecomesRight) {
  CapsuleFigure figure = MakeCapsuleFigure({.arm_angle_degrees = 10, .cell_m = .025});
  const CapsuleFigure low = MakeCapsuleFigure({.arm_angle_degrees = 60, .cell_m = .025});
  const auto half = [](const TriangleMesh& mesh, double side) {
    std::vector<int> kept;
    for (int f = 0; f < mesh.triangles.cols(); ++f) {
      double x = 0;
      for (int k = 0; k < 3; ++k) x += mesh.positions(0, mesh.triangles(k, f));
      if (side * x > 0) kept.push_back(f);
    }
    return TriangleMesh{mesh.positions, mesh.triangles(Eigen::all, kept)};
  };
  const TriangleMesh mesh = JoinMeshes(half(figure.mesh, 1), half(low.mesh, -1));
  TriangleMesh mirrored = mesh;
  mirrored.positions.row(0) *= -1;
  mirrored.triangles.row(0).swap(mirrored.triangles.row(1));  // outward again
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig a, AutoRig(MakeStillSequence(mesh), CoarseOptions()));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig b, AutoRig(MakeStillSequence(mirrored), CoarseOptions()));
  ASSERT_GT(a.skeleton.rest_position(kLeftHand).y(), a.skeleton.rest_position(kRightHand).y() + .3);
  for (int j = 0; j < kNumHumanJoints; ++j) {
    Eigen::Vector3d expected = a.skeleton.rest_position(HumanMirror()[j]);
    expected.x() *= -1;
    EXPECT_LT((b.skeleton.rest_position(j) - expected).norm(), .04)
        << HumanTemplate().joint(j).name;
  }
}

TriangleMesh Flattened() {
  TriangleMesh mesh = MakeCapsuleFigure({.cell_m = .05}).mesh;
  mesh.positions.row(2).setZero();
  return mesh;
}

TEST(UnriggableBodyTest, EveryOneIsRefusedWithItsReason) {
  TriangleMesh point = MakeBox({0, 0, 0}, {1, 1, 1}), line = point;
  point.positions.setConstant(.5);
  line.positions.topRows(2).setZero();
  const std::tuple<const char*, TriangleMesh, const char*> bodies[] = {
      {"a point", point, "none of the 12 triangles has an area"},
      {"a line", line, "none of the 12 triangles has an area"},
      {"a sheet", Flattened(), "encloses no volume"},
      {"a ball", MakeSphere({0, 1, 0}, 1, 12), "residual"},
      {"a rod", MakeCapsuleBody({{{0, 0, 0}, {0, 1.7, 0}, .05, .05}}, .04), "residual"},
  };
  AutoRigOptions options = CoarseOptions();
  options.any_orientation = false;
  options.volume.resolution = options.probe_resolution = 48;
  for (const auto& [name, mesh, words] : bodies) {
    EXPECT_THAT(AutoRig(MakeStillSequence(mesh), options),
                HasStatus(absl::StatusCode::kFailedPrecondition,
                          testing::AllOf(HasSubstr(words), HasSubstr("bring your own rig"))))
        << name;
  }
}

}  // namespace
}  // namespace pleat
