// The same body, broken or moved in the ways that real files are: the same skeleton, or a refusal
// in words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <ostream>
#include <string>

#include "pleat/base/random.h"
#include "pleat/rigging/auto_rig.h"
#include "rigging/test_bodies.h"
#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

const CapsuleFigure& Figure() {
  static const CapsuleFigure& figure = *new CapsuleFigure(MakeCapsuleFigure());
  return figure;
}

TriangleMesh WithTriangles(const TriangleMesh& mesh, const std::vector<int>& kept) {
  return {mesh.positions, mesh.triangles(Eigen::all, kept)};
}

TriangleMesh Turned(const TriangleMesh& mesh, const Eigen::Matrix3d& turn) {
  return {turn * mesh.positions, mesh.triangles};
}

// Faces taken out one by one, far from each other.
TriangleMesh WithoutFaces(const TriangleMesh& mesh, int count) {
  std::vector<int> kept(mesh.triangles.cols());
  std::iota(kept.begin(), kept.end(), 0);
  Random random(5);
  for (int i = 0; i < count; ++i) {
    kept.erase(kept.begin() +
               static_cast<int>(random.Uniform(0, static_cast<double>(kept.size()))));
  }
  return WithTriangles(mesh, kept);
}

// One wide hole: all faces within `radius` of `center`.
TriangleMesh WithHole(const TriangleMesh& mesh, const Eigen::Vector3d& center, double radius) {
  std::vector<int> kept;
  for (int f = 0; f < mesh.triangles.cols(); ++f) {
    if ((mesh.positions.col(mesh.triangles(0, f)) - center).norm() > radius) kept.push_back(f);
  }
  return WithTriangles(mesh, kept);
}

TriangleMesh WithFlippedFaces(TriangleMesh mesh, int first, int end) {
  for (int f = first; f < end; ++f) std::swap(mesh.triangles(0, f), mesh.triangles(1, f));
  return mesh;
}

// A sail of two triangles on an edge of the back: three faces meet there.
TriangleMesh WithFin(const TriangleMesh& mesh) {
  const int a = mesh.triangles(0, 0), b = mesh.triangles(1, 0);
  TriangleMesh fin = mesh;
  const int tip = static_cast<int>(mesh.positions.cols());
  fin.positions.conservativeResize(3, tip + 1);
  fin.positions.col(tip) = mesh.positions.col(a) + Eigen::Vector3d(0, .05, -.1);
  fin.triangles.conservativeResize(3, mesh.triangles.cols() + 2);
  fin.triangles.rightCols(2) << a, a, b, tip, tip, b;
  return fin;
}

// All faces above `height_m` get vertices of their own: a seam around the body.
TriangleMesh WithSeam(const TriangleMesh& mesh, double height_m) {
  TriangleMesh cut = mesh;
  const int num = static_cast<int>(mesh.positions.cols());
  cut.positions.conservativeResize(3, 2 * num);
  cut.positions.rightCols(num) = mesh.positions;
  for (int f = 0; f < cut.triangles.cols(); ++f) {
    if (mesh.positions(1, mesh.triangles(0, f)) < height_m) continue;
    cut.triangles.col(f).array() += num;
  }
  return cut;
}

TriangleMesh WithNoise(TriangleMesh mesh, double sigma_m) {
  Random random(7);
  for (int v = 0; v < mesh.positions.cols(); ++v) {
    for (int k = 0; k < 3; ++k) mesh.positions(k, v) += sigma_m * random.Normal();
  }
  return mesh;
}

struct Variant {
  std::string name;
  std::function<TriangleMesh(const TriangleMesh&)> make;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  double scale = 1;
};

void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.name; }

class BrokenVariantTest : public ::testing::TestWithParam<Variant> {};

TEST_P(BrokenVariantTest, GivesTheSameSkeleton) {
  const Variant& variant = GetParam();
  const TriangleMesh clean = Figure().mesh;
  TriangleMesh broken = variant.make(clean);
  broken.positions = variant.scale * (variant.turn * broken.positions);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig expected, AutoRig(MakeStillSequence(clean)));
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig found, AutoRig(MakeStillSequence(broken), {}, &summary));
  const Eigen::Matrix3Xd joints =
      variant.turn.transpose() * found.skeleton.RestPositions() / variant.scale;
  const Eigen::RowVectorXd errors =
      (joints - expected.skeleton.RestPositions()).colwise().norm() / kHeight;
  EXPECT_LT(errors.mean(), .03) << errors;
  EXPECT_LT(errors.maxCoeff(), .06) << errors;
  EXPECT_LT(summary.residual, .035);
  EXPECT_EQ(found.weights.num_vertices(), broken.positions.cols());
}

INSTANTIATE_TEST_SUITE_P(
    Figures, BrokenVariantTest,
    ::testing::Values(
        Variant{"Removed500Faces", [](const auto& mesh) { return WithoutFaces(mesh, 500); }},
        Variant{"HoleInTheBack",
                [](const auto& mesh) {
                  return WithHole(mesh, {0, 1.2, -.14}, .1);
                }},
        Variant{"NoTopOfTheHead",
                [](const auto& mesh) {
                  return WithHole(mesh, {0, 1.72, 0}, .12);
                }},
        Variant{"FloatingCube",
                [](const auto& mesh) {
                  return JoinMeshes(mesh, MakeBox({.6, .2, -.1}, {.8, .4, .1}));
                }},
        Variant{"AllFacesFlipped",
                [](const auto& mesh) {
                  return WithFlippedFaces(mesh, 0, static_cast<int>(mesh.triangles.cols()));
                }},
        Variant{"OneFaceFlipped",
                [](const auto& mesh) { return WithFlippedFaces(mesh, 100, 101); }},
        Variant{"HalfTheFacesFlipped",
                [](const auto& mesh) {
                  return WithFlippedFaces(mesh, 0, static_cast<int>(mesh.triangles.cols()) / 2);
                }},
        Variant{"Fin", [](const auto& mesh) { return WithFin(mesh); }},
        Variant{"Seam", [](const auto& mesh) { return WithSeam(mesh, 1.1); }},
        Variant{"Noise3mm", [](const auto& mesh) { return WithNoise(mesh, .003); }}),
    [](const auto& instance) { return instance.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Moved, BrokenVariantTest,
    ::testing::Values(
        Variant{"Centimeters", [](const auto& mesh) { return mesh; }, Eigen::Matrix3d::Identity(),
                100},
        Variant{"Inches", [](const auto& mesh) { return mesh; }, Eigen::Matrix3d::Identity(),
                1 / .0254},
        Variant{"ZUp", [](const auto& mesh) { return mesh; }, TurnAbout({1, 0, 0}, 90)},
        Variant{"UpsideDown", [](const auto& mesh) { return mesh; }, TurnAbout({0, 0, 1}, 180)},
        Variant{"LyingOnItsSide", [](const auto& mesh) { return mesh; }, TurnAbout({0, 0, 1}, 90)},
        Variant{"Leaning", [](const auto& mesh) { return mesh; }, TurnAbout({1, 0, .5}, 35)},
        Variant{"AnyAxis", [](const auto& mesh) { return mesh; }, TurnAbout({1, 2, 3}, 100)},
        Variant{"AnotherAxis", [](const auto& mesh) { return mesh; }, TurnAbout({-2, 1, 1}, 147)}),
    [](const auto& instance) { return instance.param.name; });

// Without feet a body that stands still does not show its front: the same skeleton, or the mirrored
// one with a warning, or a refusal.
TEST(BrokenVariants, CutOffFeetKeepTheRest) {
  const TriangleMesh clean = Figure().mesh;
  std::vector<int> kept;
  for (int f = 0; f < clean.triangles.cols(); ++f) {
    if (clean.positions(1, clean.triangles(0, f)) > .09) kept.push_back(f);
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig expected, AutoRig(MakeStillSequence(clean)));
  AutoRigSummary summary;
  const absl::StatusOr<Rig> found =
      AutoRig(MakeStillSequence(WithTriangles(clean, kept)), {}, &summary);
  if (!found.ok()) {
    EXPECT_THAT(found.status(),
                HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("own rig")));
    return;
  }
  EXPECT_THAT(summary.warnings, ::testing::Contains(HasSubstr("set the yaw")));
  double straight = 0, mirrored = 0;
  for (int j = 0; j < kNumHumanJoints; ++j) {
    if (j == kLeftFoot || j == kLeftToes || j == kRightFoot || j == kRightToes) continue;
    const Eigen::Vector3d truth = expected.skeleton.rest_position(j);
    straight += (found->skeleton.rest_position(j) - truth).norm() / kNumHumanJoints;
    mirrored += (found->skeleton.rest_position(HumanMirror()[j]) - truth).norm() / kNumHumanJoints;
  }
  EXPECT_LT(std::min(straight, mirrored), .03 * kHeight);
}

TEST(BrokenVariants, TurnedBodiesAreReported) {
  AutoRigSummary summary;
  ASSERT_THAT(
      AutoRig(MakeStillSequence(Turned(Figure().mesh, TurnAbout({1, 0, 0}, 90))), {}, &summary),
      IsOk());
  EXPECT_GT(summary.up.z(), .95);
  EXPECT_THAT(summary.warnings, ::testing::Contains(HasSubstr("Y up")));
  AutoRigOptions strict;
  strict.any_orientation = false;
  EXPECT_FALSE(
      AutoRig(MakeStillSequence(Turned(Figure().mesh, TurnAbout({0, 0, 1}, 180))), strict).ok());
}

TEST(BrokenVariants, HalfABodyIsRefused) {
  const TriangleMesh clean = Figure().mesh;
  std::vector<int> upper;
  for (int f = 0; f < clean.triangles.cols(); ++f) {
    if (clean.positions(1, clean.triangles(0, f)) > .9) upper.push_back(f);
  }
  EXPECT_THAT(AutoRig(MakeStillSequence(WithTriangles(clean, upper))),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("own rig")));
}

TEST(BrokenVariants, AQuadrupedStaysOneInEveryOrientation) {
  const TriangleMesh horse = MakeCapsuleQuadruped();
  for (const Eigen::Matrix3d& turn :
       {TurnAbout({1, 0, 0}, 90), TurnAbout({1, 0, 0}, -90), TurnAbout({0, 0, 1}, 90)}) {
    EXPECT_THAT(AutoRig(MakeStillSequence(Turned(horse, turn))),
                HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("own rig")));
  }
}

}  // namespace
}  // namespace pleat
