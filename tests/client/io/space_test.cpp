#include "cli/io/space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/exit_code.h"
#include "client/test_sequence.h"
#include "pleat/formats/sequence_file.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(Space, UnitsAndAxesArePeoples) {
  EXPECT_EQ(*ParseUnit("--unit", "cm"), 0.01);
  EXPECT_EQ(*ParseUnit("--unit", "0.0254"), *ParseUnit("--unit", "in"));
  EXPECT_TRUE(IsUsageError(ParseUnit("--unit", "parsec").status()));
  EXPECT_TRUE(IsUsageError(ParseUnit("--unit", "-1").status()));
  EXPECT_EQ(*ParseUp("--up", "Z"), UpAxis::kZ);
  EXPECT_TRUE(IsUsageError(ParseUp("--up", "x").status()));
  EXPECT_EQ(DescribeSpace({0.01, UpAxis::kZ}), "centimeters, Z up");
  EXPECT_EQ(DescribeSpace({0.5, UpAxis::kY}), "units of 0.5 m, Y up");
}

TEST(Space, PackagesAreKnown) {
  for (const char* name : {"blender", "maya", "houdini", "unreal", "unity", "godot"}) {
    EXPECT_THAT(FindPackage(name), IsOk());
  }
  EXPECT_EQ(FindPackage("maya")->space.unit_m, 0.01);
  EXPECT_TRUE(IsUsageError(FindPackage("word").status()));
}

TEST(Space, TheSameSpaceChangesNothing) {
  const MeshSequence sequence = MovingTetrahedron(2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence same, InSpace(sequence, {}, {}));
  EXPECT_EQ(EncodeSequence(same), EncodeSequence(sequence));
}

TEST(Space, AxesTurnAndComeBack) {
  const MeshSequence sequence = MovingTetrahedron(2);
  const Space maya_z{0.01, UpAxis::kZ};
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence there, InSpace(sequence, {}, maya_z));
  // Vertex 2 is one meter up, vertex 3 one meter to the front (+z of Y up is -y of Z up).
  EXPECT_LT((there.frame(0).col(2) - Eigen::Vector3f(0, 0, 100)).norm(), 1e-4);
  EXPECT_LT((there.frame(0).col(3) - Eigen::Vector3f(0, -100, 0)).norm(), 1e-4);
  EXPECT_EQ(there.frame_rate(), sequence.frame_rate());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back, InSpace(there, maya_z, {}));
  for (int t = 0; t < 2; ++t) {
    EXPECT_LT((back.frame(t) - sequence.frame(t)).cwiseAbs().maxCoeff(), 1e-6);
  }
}

}  // namespace
}  // namespace pleat
