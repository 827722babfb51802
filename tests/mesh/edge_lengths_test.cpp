#include "pleat/mesh/edge_lengths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/mesh_shapes.h"

namespace pleat {
namespace {

TEST(EdgeLengthsTest, EveryEdgeOnceAndOfManyAnEvenSample) {
  const MeshShape box = MakeBox({1, 2, 3});
  EXPECT_EQ(SampleEdges(box.topology, 100).size(), 12u);
  const MeshShape sphere = MakeUvSphere(1, 20, 40);
  const size_t all = SampleEdges(sphere.topology, 1 << 20).size();
  EXPECT_EQ(all, 20u * 40 + 21 * 40);  // circles and meridians
  const size_t some = SampleEdges(sphere.topology, 500).size();
  EXPECT_LE(some, 500u);
  EXPECT_GT(some, 250u);
}

TEST(EdgeLengthsTest, LengthsAreThoseOfTheShapeButNeverNearlyZero) {
  const MeshShape box = MakeBox({1, 2, 3});
  const std::vector<Edge> edges = SampleEdges(box.topology, 100);
  std::vector<float> lengths = EdgeLengths(edges, box.positions.cast<float>());
  std::ranges::sort(lengths);
  EXPECT_FLOAT_EQ(lengths[0], 1);
  EXPECT_FLOAT_EQ(lengths[11], 3);
  Eigen::Matrix3Xf flat = box.positions.cast<float>();
  flat.row(0).setZero();
  EXPECT_FLOAT_EQ(std::ranges::min(EdgeLengths(edges, flat)), .05f * 2);
}

TEST(EdgeLengthsTest, ScaleIsTakenOutOfTheShares) {
  const std::vector<float> before(10, 1);
  std::vector<float> after(10, 7);
  EXPECT_DOUBLE_EQ(CompareEdgeLengths(before, after).scale, 7);
  EXPECT_EQ(CompareEdgeLengths(before, after).share_moderate, 0);
  after[0] = 10;   // x 1.43
  after[1] = 3;    // / 2.3
  after[2] = 100;  // x 14
  const EdgeChange change = CompareEdgeLengths(before, after);
  EXPECT_DOUBLE_EQ(change.scale, 7);
  EXPECT_DOUBLE_EQ(change.share_moderate, .3);
  EXPECT_DOUBLE_EQ(change.share_large, .2);
  EXPECT_DOUBLE_EQ(change.share_extreme, .1);
}

TEST(EdgeLengthsTest, NoEdgesAndNoExtentAreNoChange) {
  EXPECT_EQ(CompareEdgeLengths({}, {}).scale, 1);
  const MeshShape box = MakeBox({1, 1, 1});
  const std::vector<Edge> edges = SampleEdges(box.topology, 100);
  const std::vector<float> point = EdgeLengths(edges, Eigen::Matrix3Xf::Zero(3, 8));
  EXPECT_EQ(CompareEdgeLengths(point, point).share_moderate, 0);
  // From a point to a box: any answer but a crash or a NaN.
  EXPECT_GT(CompareEdgeLengths(point, EdgeLengths(edges, box.positions.cast<float>())).scale, 0);
}

}  // namespace
}  // namespace pleat
