#include "pleat/rigging/search_tree.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

TEST(SearchTreeTest, ChainsCoverTheHumanTemplateOnce) {
  const SearchTree tree = MakeHumanSearchTree(1, 0);
  ASSERT_EQ(tree.size(), 7u);
  std::multiset<int> covered = {tree[0].human_joint};
  for (size_t j = 1; j < tree.size(); ++j) {
    EXPECT_LT(tree[j].parent, static_cast<int>(j));
    EXPECT_EQ(tree[j].chain.back(), tree[j].human_joint);
    EXPECT_DOUBLE_EQ(tree[j].fractions.back(), 1);
    EXPECT_TRUE(std::is_sorted(tree[j].fractions.begin(), tree[j].fractions.end()));
    covered.insert(tree[j].chain.begin(), tree[j].chain.end());
    if (tree[j].mirror >= 0) {
      EXPECT_EQ(tree[tree[j].mirror].mirror, static_cast<int>(j));
      EXPECT_EQ(tree[tree[j].mirror].human_joint, HumanMirror()[tree[j].human_joint]);
    }
  }
  EXPECT_EQ(covered.size(), static_cast<size_t>(kNumHumanJoints));
  EXPECT_EQ(std::set<int>(covered.begin(), covered.end()).size(), covered.size());
}

TEST(SearchTreeTest, ChainsAddUpToTheJoint) {
  const SearchTree tree = MakeHumanSearchTree(1.7, .4);
  for (const SearchJoint& joint : tree) {
    if (joint.parent < 0) continue;
    const Eigen::Vector3d end = tree[joint.parent].position + joint.directions * joint.bone_lengths;
    EXPECT_LT((end - joint.position).norm(), 1e-12);
  }
}

TEST(SearchTreeTest, SizeScalesLengthsAndWholeTurnsChangeNothing) {
  const SearchTree one = MakeHumanSearchTree(1, .7);
  const SearchTree twice = MakeHumanSearchTree(2, .7 + 2 * std::numbers::pi);
  for (size_t j = 0; j < one.size(); ++j) {
    EXPECT_LT((twice[j].position - 2 * one[j].position).norm(), 1e-12);
    EXPECT_NEAR(twice[j].length, 2 * one[j].length, 1e-12);
    EXPECT_EQ(twice[j].is_leaf, one[j].is_leaf);
    if (one[j].parent < 0) continue;
    EXPECT_LT((twice[j].directions - one[j].directions).norm(), 1e-12);
    EXPECT_NEAR(one[j].bone_lengths.sum(), one[j].length, 1e-12);
    EXPECT_LT((one[j].directions.colwise().norm().array() - 1).abs().maxCoeff(), 1e-12);
    if (one[j].mirror >= 0) {
      EXPECT_NEAR(one[one[j].mirror].length, one[j].length, 1e-9);
    }
  }
}

TEST(SearchTreeTest, YawTurnsFromPlusZTowardsPlusX) {
  const SearchTree ahead = MakeHumanSearchTree(1, 0);
  const SearchTree side = MakeHumanSearchTree(1, std::numbers::pi / 2);
  EXPECT_GT(ahead[3].position.x(), 0);  // left toes at +x when facing +z
  EXPECT_NEAR(side[3].position.z(), -ahead[3].position.x(), 1e-12);
  EXPECT_NEAR(side[3].position.x(), ahead[3].position.z(), 1e-12);
}

}  // namespace
}  // namespace pleat
