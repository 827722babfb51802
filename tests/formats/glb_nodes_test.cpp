#include "glb_nodes.h"

#include <gtest/gtest.h>

#include "figure_glb.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

absl::StatusOr<GlbNodes> ReadNodes(const json& nodes) {
  FigureGltf gltf;
  gltf.root["nodes"] = nodes;
  const std::string bytes = PackFigureGltf(gltf);
  const absl::StatusOr<GlbContainer> glb = GlbContainer::Open(bytes);
  if (!glb.ok()) return glb.status();
  return GlbNodes::Read(*glb);
}

TEST(GlbNodes, TransformsArePutTogetherFromTheRootOn) {
  // The child is listed before its parent.
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const GlbNodes nodes,
      ReadNodes({{{"translation", {0, 0, 1}}},
                 {{"children", {0}}, {"scale", {1, 2, 3}}, {"translation", {5, 0, 0}}}}));
  EXPECT_EQ(nodes.count(), 2);
  EXPECT_EQ(nodes.parent(0), 1);
  EXPECT_EQ(nodes.parent(1), -1);
  EXPECT_EQ(nodes.world_from_node(0) * Eigen::Vector4d(1, 1, 1, 1), Eigen::Vector4d(6, 2, 6, 1));
  EXPECT_THAT(nodes.shown(), ElementsAre(0, 1));
}

TEST(GlbNodes, WhatIsNoTreeIsRefused) {
  EXPECT_THAT(ReadNodes({{{"children", {1}}}, {{"children", {0}}}}),
              HasStatus(kInvalid, HasSubstr("node 0 is its own ancestor")));
  EXPECT_THAT(ReadNodes({{{"children", {2}}}, {{"children", {2}}}, json::object()}),
              HasStatus(kInvalid, HasSubstr("two parents")));
  EXPECT_THAT(ReadNodes({json::object(), {{"scale", {1, 2}}}}),
              HasStatus(kInvalid, HasSubstr("node 1")));
  EXPECT_THAT(ReadNodes({{{"rotation", {0, 0, 0, 0}}}}),
              HasStatus(kInvalid, HasSubstr("rotation is zero")));
}

// A chain of many nodes is read in time that grows with their number alone.
TEST(GlbNodes, LongChainsAreRead) {
  constexpr int kCount = 100'000;
  json chain = json::array();
  for (int n = 0; n + 1 < kCount; ++n) {
    chain.push_back({{"children", {n + 1}}, {"translation", {0, 1, 0}}});
  }
  chain.push_back(json::object());
  PLEAT_ASSERT_OK_AND_ASSIGN(const GlbNodes nodes, ReadNodes(chain));
  EXPECT_EQ(nodes.world_from_node(kCount - 1)(1, 3), kCount - 1);
}

}  // namespace
}  // namespace pleat
