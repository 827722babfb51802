#include "pleat/rigging/search_chains.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/base/random.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;

// A bent rod: spheres at 0, 1, 3 along x, then 2 up.
SphereGraph BentRod() {
  return SphereGraph({{{0, 0, 0}, .1}, {{1, 0, 0}, .3}, {{3, 0, 0}, .2}, {{3, 2, 0}, .1}},
                     {{0, 1}, {1, 2}, {2, 3}});
}

TEST(SearchChainsTest, PointsLieAtTheirSharesOfThePath) {
  const SphereGraph graph = BentRod();
  Eigen::Matrix3Xd points(3, 5);
  PlaceOnPath(graph, 0, 3, {0, .1, .6, .8, 1}, points);
  Eigen::Matrix3Xd expected(3, 5);
  expected << 0, .5, 3, 3, 3, 0, 0, 0, 1, 2, 0, 0, 0, 0, 0;
  EXPECT_LT((points - expected).cwiseAbs().maxCoeff(), 1e-12) << points;
  PlaceOnPath(graph, 3, 0, {0, .2, .4, .9, 1}, points);
  expected << 3, 3, 3, .5, 0, 2, 1, 0, 0, 0, 0, 0, 0, 0, 0;
  EXPECT_LT((points - expected).cwiseAbs().maxCoeff(), 1e-12) << points;
}

TEST(SearchChainsTest, APathOfOneSphereIsItsCenter) {
  Eigen::Matrix3Xd points(3, 2);
  PlaceOnPath(BentRod(), 1, 1, {.5, 1}, points);
  EXPECT_EQ(points.col(0), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(points.col(1), Eigen::Vector3d(1, 0, 0));
}

TEST(SearchChainsTest, CandidatesAreTheLargestTheEndsOrNearThePlace) {
  const SearchTree tree = MakeHumanSearchTree(1, 0);
  const SearchChains chains(BentRod(), tree, 2, {{kLeftHand, {2.9, 1.9, 0}}});
  ASSERT_EQ(tree[2].human_joint, kHead);
  ASSERT_EQ(tree[5].human_joint, kLeftHand);
  EXPECT_THAT(chains.candidates(0), ElementsAre(1, 2));
  EXPECT_THAT(chains.candidates(2), ElementsAre(1, 2));
  EXPECT_THAT(chains.candidates(3), ElementsAre(0, 2, 3));  // the rod bends at 2
  EXPECT_THAT(chains.candidates(5), ElementsAre(3, 2, 1));
  EXPECT_THAT(chains.candidates(6), ElementsAre(0, 2, 3));
}

TEST(SearchChainsTest, ChainsRunFromTheParentsCandidateToTheOwn) {
  Random random(2);
  std::vector<Sphere> spheres;
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < 20; ++i) {
    spheres.push_back({{random.Uniform(), random.Uniform(), random.Uniform()}, random.Uniform()});
    if (i > 0) edges.push_back({i, random.UniformInt(i)});
  }
  const SphereGraph graph(spheres, edges);
  const SearchTree tree = MakeHumanSearchTree(1, 0);
  const SearchChains chains(graph, tree, 5, {});
  for (int j = 1; j < static_cast<int>(tree.size()); ++j) {
    const std::vector<int>& own = chains.candidates(j);
    const std::vector<int>& parents = chains.candidates(tree[j].parent);
    for (size_t c = 0; c < own.size(); ++c) {
      for (size_t p = 0; p < parents.size(); ++p) {
        Eigen::Matrix3Xd expected(3, tree[j].chain.size());
        PlaceOnPath(graph, parents[p], own[c], tree[j].fractions, expected);
        EXPECT_EQ(Eigen::Matrix3Xd(chains.points(j, c, p)), expected);
      }
    }
  }
}

}  // namespace
}  // namespace pleat
