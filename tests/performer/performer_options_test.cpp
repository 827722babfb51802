// What each option promises: what it changes, what it leaves alone, and where it ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "pleat/performer/performer.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// Style, seed and length of a motion do not touch them.
TEST(PerformerOptionsTest, MotionsOfOneCharacterShareMeshAndWeights) {
  PerformerOptions options{.num_frames = 2, .num_vertices = 800};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer first, GeneratePerformer(options));
  options.seed = 9;
  options.style = PerformerStyle::kWalk;
  options.num_frames = 4;
  options.frame_rate = {60, 1};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer second, GeneratePerformer(options));
  EXPECT_TRUE(first.sequence.topology() == second.sequence.topology());
  EXPECT_EQ(first.truth.rig.rest_positions, second.truth.rig.rest_positions);
  EXPECT_EQ(first.truth.rig.weights.ToDense(), second.truth.rig.weights.ToDense());
  EXPECT_EQ(first.truth.rig.skeleton.RestPositions(), second.truth.rig.skeleton.RestPositions());
  EXPECT_EQ(first.truth.is_skirt, second.truth.is_skirt);
}

// The whole performance turns with the character: 90 degrees take +z to +x.
TEST(PerformerOptionsTest, FacingTurnsTheWholePerformance) {
  PerformerOptions options{.num_frames = 12, .num_vertices = 800};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer ahead, GeneratePerformer(options));
  for (const double yaw_degrees : {90., -135., 360.}) {
    options.yaw_degrees = yaw_degrees;
    PLEAT_ASSERT_OK_AND_ASSIGN(const Performer turned, GeneratePerformer(options));
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(yaw_degrees * M_PI / 180, Eigen::Vector3d::UnitY()).toRotationMatrix();
    if (yaw_degrees == 90) {
      EXPECT_LT((turn * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
    }
    EXPECT_TRUE(turned.sequence.topology() == ahead.sequence.topology());
    EXPECT_EQ(turned.truth.rig.weights.ToDense(), ahead.truth.rig.weights.ToDense());
    for (int t = 0; t < 12; ++t) {
      EXPECT_LT((turned.sequence.FrameAsDouble(t) - turn * ahead.sequence.FrameAsDouble(t))
                    .cwiseAbs()
                    .maxCoeff(),
                2e-6)
          << yaw_degrees << " " << t;
      // The joints turn alike; their rotations are written in the axes of the rest pose.
      BoneTransforms bones, turned_bones;
      ComputeBoneTransforms(ahead.truth.rig.skeleton, ahead.truth.track.pose(t), {}, &bones);
      ComputeBoneTransforms(turned.truth.rig.skeleton, turned.truth.track.pose(t), {},
                            &turned_bones);
      EXPECT_LT((turned_bones.joint_positions - turn * bones.joint_positions).norm(), 1e-9);
    }
  }
}

TEST(PerformerOptionsTest, HeightScalesTheRestShapeAndItsSkeleton) {
  PerformerOptions options{.num_frames = 1, .num_vertices = 800};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer person, GeneratePerformer(options));
  for (const double height_m : {.1, 10.}) {  // the ends of what is allowed
    options.height_m = height_m;
    PLEAT_ASSERT_OK_AND_ASSIGN(const Performer other, GeneratePerformer(options));
    const double scale = height_m / 1.7;
    EXPECT_TRUE(other.sequence.topology() == person.sequence.topology());
    EXPECT_LT((other.truth.rig.rest_positions - scale * person.truth.rig.rest_positions)
                  .cwiseAbs()
                  .maxCoeff(),
              1e-6 * height_m);
    EXPECT_LT((other.truth.rig.skeleton.RestPositions() -
               scale * person.truth.rig.skeleton.RestPositions())
                  .norm(),
              1e-9 * height_m);
  }
}

struct OutOfRange {
  const char* option;
  PerformerOptions options;
};

class PerformerRangeTest : public testing::TestWithParam<OutOfRange> {};

TEST_P(PerformerRangeTest, IsNamed) {
  EXPECT_THAT(GeneratePerformer(GetParam().options),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(GetParam().option)));
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

INSTANTIATE_TEST_SUITE_P(Options, PerformerRangeTest,
                         testing::Values(OutOfRange{"num_frames", {.num_frames = -1}},
                                         OutOfRange{"num_frames", {.num_frames = 100001}},
                                         OutOfRange{"num_vertices", {.num_vertices = 499}},
                                         OutOfRange{"num_vertices", {.num_vertices = 100001}},
                                         OutOfRange{"16 GiB",
                                                    {.num_frames = 100000, .num_vertices = 100000}},
                                         OutOfRange{"frame_rate", {.frame_rate = {49, 10}}},
                                         OutOfRange{"frame_rate", {.frame_rate = {2401, 10}}},
                                         OutOfRange{"frame_rate", {.frame_rate = {30, -1}}},
                                         OutOfRange{"frame_rate", {.frame_rate = {-30, 1}}},
                                         OutOfRange{"height_m", {.height_m = .0999}},
                                         OutOfRange{"height_m", {.height_m = 10.01}},
                                         OutOfRange{"height_m", {.height_m = -1.7}},
                                         OutOfRange{"yaw_degrees", {.yaw_degrees = kInfinity}},
                                         OutOfRange{"yaw_degrees", {.yaw_degrees = 361}}));

TEST(PerformerOptionsTest, TheSmallestOfEverythingIsAPerformer) {
  for (const FrameRate rate : {FrameRate{5, 1}, FrameRate{240, 1}}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Performer performer,
        GeneratePerformer({.num_frames = 1, .num_vertices = 500, .frame_rate = rate}));
    EXPECT_EQ(performer.sequence.num_frames(), 1);
    EXPECT_EQ(performer.truth.track.num_frames(), 1);
    EXPECT_EQ(performer.truth.is_skirt.size(),
              static_cast<size_t>(performer.sequence.num_vertices()));
    const Topology& topology = performer.sequence.topology();
    EXPECT_EQ(topology.num_triangles(), 2 * topology.num_vertices() - 4);  // genus 0
  }
}

}  // namespace
}  // namespace pleat
